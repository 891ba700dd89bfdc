//! Names of rows in plots: only what distinguishes the rows.

use super::super::model::{Row, Varied};
use crate::measure::plot::figure;

const SIZE: &str = "picture size";

fn size(row: &Row) -> String {
    let [width, height] = row.size;
    format!("{width}×{height}")
}

/// Properties that can distinguish rows, in the order in which they are named.
fn properties(row: &Row) -> Vec<(String, String)> {
    let mut all = vec![
        ("world".to_owned(), row.world.clone()),
        ("camera".to_owned(), row.camera.clone()),
        ("layout".to_owned(), row.layout.clone().unwrap_or_default()),
        ("condition".to_owned(), row.condition.clone()),
    ];
    all.extend(
        row.varied
            .iter()
            .map(|(key, value)| (key.clone(), shown(value))),
    );
    all.extend([
        (SIZE.to_owned(), size(row)),
        ("card".to_owned(), card(row).to_owned()),
    ]);
    all
}

pub fn shown(value: &Varied) -> String {
    match value {
        Varied::Number(number) => figure(*number),
        Varied::Text(text) => text.clone(),
    }
}

/// The card's label in a merged report, else the name of the adapter.
pub fn card(row: &Row) -> &str {
    row.id
        .rsplit_once('@')
        .map_or(&row.adapter.name, |(_, label)| label)
}

/// Properties that differ between rows, except those in `without`, which are shown in another way.
pub fn differing(rows: &[&Row], without: &[&str]) -> Vec<String> {
    let all: Vec<Vec<(String, String)>> = rows.iter().map(|row| properties(row)).collect();
    let value = |index: usize, key: &str| {
        let found = all[index].iter().find(|(known, _)| known == key);
        found.map(|(_, value)| value.as_str())
    };
    let keys = distinct(all.iter().flatten().map(|(key, _)| key.as_str()));
    let differs = |key: &&str| {
        !without.contains(key) && (1..all.len()).any(|index| value(index, key) != value(0, key))
    };
    let mut keys: Vec<String> = keys
        .into_iter()
        .filter(differs)
        .map(str::to_owned)
        .collect();
    // A suite that varies the size names it already.
    if rows.iter().any(|row| {
        row.varied
            .values()
            .any(|value| shown(value).replace('x', "×") == size(row))
    }) {
        keys.retain(|key| key != SIZE);
    }
    keys
}

/// A name for each row, made of the properties that differ. `without` names properties that are shown in
/// another way.
pub fn names(rows: &[&Row], without: &[&str]) -> Vec<String> {
    named(rows, without, false)
}

/// The same with the keys that a suite varies: `rays 64`.
pub fn names_with_keys(rows: &[&Row], without: &[&str]) -> Vec<String> {
    named(rows, without, true)
}

fn named(rows: &[&Row], without: &[&str], with_keys: bool) -> Vec<String> {
    let differing = differing(rows, without);
    let name = |row: &&Row| {
        let parts = properties(row).into_iter();
        let parts = parts.filter(|(key, text)| differing.contains(key) && !text.is_empty());
        let parts: Vec<String> = parts
            .map(
                |(key, text)| match with_keys && row.varied.contains_key(&key) {
                    true => format!("{} {text}", short(&key)),
                    false => text,
                },
            )
            .collect();
        match parts[..] {
            // No property differs: one row, or rows that are distinguished by something else.
            [] => row.layout.clone().unwrap_or_else(|| row.world.clone()),
            _ => parts.join(" "),
        }
    };
    rows.iter().map(name).collect()
}

/// The last part of a key: `probes.rays` → `rays`; the whole key where its last part says nothing.
pub fn short(key: &str) -> &str {
    match key.rsplit_once('.') {
        Some((_, last)) if !["count", "size", "enabled"].contains(&last) => last,
        _ => key,
    }
}

/// The different values, in order of first appearance.
pub fn distinct<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for value in values {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{super::super::made_up, *};

    #[test]
    fn names_say_what_differs() {
        let report = made_up::report();
        let rows: Vec<&Row> = report.rows[..3].iter().collect();
        assert_eq!(
            names(&rows, &[]),
            ["layout1 still", "layout1 moving", "layout2 still"]
        );
        assert_eq!(names(&rows, &["condition"])[2], "layout2");
        assert_eq!(names(&rows[..1], &[]), ["layout1"]);
        let rays: Vec<&Row> = report
            .rows
            .iter()
            .filter(|row| row.suite == "rays")
            .collect();
        // The layout is left out: it is the same in all rows.
        assert_eq!(names(&rays, &[]), ["8", "64", "512"]);
        assert_eq!(names_with_keys(&rays, &[])[0], "rays 8");
        assert_eq!(differing(&rays, &[]), ["probes.rays"]);
        assert_eq!(
            (short("probes.rays"), short("lights.count")),
            ("rays", "lights.count")
        );
    }
}

//! The output of the grammar: a tree of its choices, which prints as the text of a world file.
//!
//! A node is any RON value. So every node can be shrunk in the same few ways, whatever it means, and the reader
//! of world files decides which of the results are valid worlds.

use std::fmt;

/// A node of a world file.
#[derive(Clone, Debug, PartialEq)]
pub enum Term {
    Number(f64),
    /// A choice without parts: `Perlin`, `true`.
    Word(&'static str),
    /// A text in quotes.
    Text(String),
    /// `Name(a, b)`; a vector has no name.
    Tuple(&'static str, Vec<Term>),
    /// `Name(key: a, key: b)`; the name may be empty.
    Record(&'static str, Vec<(&'static str, Term)>),
    List(Vec<Term>),
    /// `{"name": a, "name": b}`
    Map(Vec<(String, Term)>),
}

/// The position of a node: the index of a child, of that child's child, and so on.
pub type Path = Vec<usize>;

/// One step towards a simpler tree.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Removes children, starting at `first`, from the node at the path.
    Remove {
        path: Path,
        first: usize,
        count: usize,
    },
    /// Replaces the node at the path by something simpler.
    Replace { path: Path, with: Term },
}

impl Term {
    pub fn vector(of: [f64; 3]) -> Self {
        Self::Tuple("", of.map(Self::Number).to_vec())
    }

    pub fn text(of: impl Into<String>) -> Self {
        Self::Text(of.into())
    }

    /// The number of nodes in the tree.
    pub fn nodes(&self) -> usize {
        1 + self
            .children()
            .iter()
            .map(|child| child.nodes())
            .sum::<usize>()
    }

    fn children(&self) -> Vec<&Self> {
        match self {
            Self::Number(_) | Self::Word(_) | Self::Text(_) => Vec::new(),
            Self::Tuple(_, of) | Self::List(of) => of.iter().collect(),
            Self::Record(_, of) => of.iter().map(|(_, child)| child).collect(),
            Self::Map(of) => of.iter().map(|(_, child)| child).collect(),
        }
    }

    fn child_mut(&mut self, index: usize) -> Option<&mut Self> {
        match self {
            Self::Number(_) | Self::Word(_) | Self::Text(_) => None,
            Self::Tuple(_, of) | Self::List(of) => of.get_mut(index),
            Self::Record(_, of) => of.get_mut(index).map(|(_, child)| child),
            Self::Map(of) => of.get_mut(index).map(|(_, child)| child),
        }
    }

    fn at_mut(&mut self, path: &[usize]) -> Option<&mut Self> {
        path.iter()
            .try_fold(self, |node, &index| node.child_mut(index))
    }

    /// Whether children can be removed. Children of a tuple cannot: their positions have meanings.
    fn is_collection(&self) -> bool {
        matches!(self, Self::List(_) | Self::Record(..) | Self::Map(_))
    }

    /// Whether the node has a name, such as `Sphere(…)`.
    fn is_named(&self) -> bool {
        matches!(self, Self::Record(name, _) | Self::Tuple(name, _) if !name.is_empty())
    }

    /// Every possible step; those that remove most come first.
    pub fn steps(&self) -> Vec<Step> {
        let mut steps = Vec::new();
        let mut level: Vec<(Path, &Self)> = vec![(Vec::new(), self)];
        while !level.is_empty() {
            for (path, node) in &level {
                node.own_steps(path, &mut steps);
            }
            let below = level.iter().flat_map(|(path, node)| {
                let children = node.children().into_iter().enumerate();
                children.map(move |(index, child)| ([path.as_slice(), &[index]].concat(), child))
            });
            level = below.collect();
        }
        // Numbers last: there are many, and simplifying them removes nothing.
        steps.sort_by_key(|step| {
            matches!(
                step,
                Step::Replace {
                    with: Self::Number(_),
                    ..
                }
            )
        });
        steps
    }

    fn own_steps(&self, path: &Path, steps: &mut Vec<Step>) {
        let children = self.children();
        if self.is_collection() {
            let remove = |first, count| Step::Remove {
                path: path.clone(),
                first,
                count,
            };
            let mut count = children.len() / 2;
            // The keys of a record are independent of each other, and few can be left out.
            while count > 1 && !matches!(self, Self::Record(..)) {
                let firsts = (0..children.len()).step_by(count);
                steps.extend(firsts.map(|first| remove(first, count.min(children.len() - first))));
                count /= 2;
            }
            steps.extend((0..children.len()).map(|first| remove(first, 1)));
        }
        let replace = |with| Step::Replace {
            path: path.clone(),
            with,
        };
        if self.is_named() {
            let lists = children.iter().flat_map(|child| match child {
                Self::List(of) => of.iter().collect(),
                other => vec![*other],
            });
            let parts = lists.filter(|part| part.is_named() || matches!(part, Self::Word(_)));
            steps.extend(parts.cloned().map(replace));
        }
        if let Self::Number(value) = self {
            let half = (value / 2.0).round();
            for simpler in [0.0, 1.0, half, value.round()] {
                if simpler != *value && simpler.abs() <= value.abs() {
                    steps.push(replace(Self::Number(simpler)));
                }
            }
        }
    }

    /// The tree after a step; `None` where it does not apply.
    pub fn after(&self, step: &Step) -> Option<Self> {
        let mut tree = self.clone();
        match step {
            Step::Remove { path, first, count } => {
                let range = *first..first + count;
                match tree.at_mut(path)? {
                    Self::List(of) if range.end <= of.len() => drop(of.drain(range)),
                    Self::Record(_, of) if range.end <= of.len() => drop(of.drain(range)),
                    Self::Map(of) if range.end <= of.len() => drop(of.drain(range)),
                    _ => return None,
                }
            }
            Step::Replace { path, with } => *tree.at_mut(path)? = with.clone(),
        }
        Some(tree)
    }

    /// The text of a file: each key of the outermost record is on its own line.
    pub fn file(&self) -> String {
        let Self::Record(_, keys) = self else {
            return format!("{self}\n");
        };
        let lines = keys
            .iter()
            .map(|(key, value)| format!("    {key}: {value},\n"));
        format!("(\n{})\n", lines.collect::<String>())
    }
}

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fn all(
            f: &mut fmt::Formatter<'_>,
            of: impl Iterator<Item = (String, Term)>,
        ) -> fmt::Result {
            for (index, (key, child)) in of.enumerate() {
                let comma = if index == 0 { "" } else { ", " };
                write!(f, "{comma}{key}{child}")?;
            }
            Ok(())
        }
        match self {
            Self::Number(value) => write!(f, "{value}"),
            Self::Word(word) => f.write_str(word),
            Self::Text(text) => write!(f, "{text:?}"),
            Self::Tuple(name, of) => {
                write!(f, "{name}(")?;
                all(f, of.iter().map(|child| (String::new(), child.clone())))?;
                f.write_str(")")
            }
            Self::Record(name, of) => {
                write!(f, "{name}(")?;
                all(
                    f,
                    of.iter()
                        .map(|(key, child)| (format!("{key}: "), child.clone())),
                )?;
                f.write_str(")")
            }
            Self::List(of) => {
                f.write_str("[")?;
                all(f, of.iter().map(|child| (String::new(), child.clone())))?;
                f.write_str("]")
            }
            Self::Map(of) => {
                f.write_str("{")?;
                all(
                    f,
                    of.iter()
                        .map(|(key, child)| (format!("{key:?}: "), child.clone())),
                )?;
                f.write_str("}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree() -> Term {
        let sphere = |radius| Term::Record("Sphere", vec![("radius", Term::Number(radius))]);
        Term::Record(
            "",
            vec![
                ("title", Term::text("a \"test\"")),
                ("size", Term::vector([8.0, 9.5, 1.0])),
                (
                    "shape",
                    Term::Tuple("Union", vec![Term::List(vec![sphere(2.0), sphere(3.0)])]),
                ),
                ("sun", Term::Word("None")),
            ],
        )
    }

    #[test]
    fn a_tree_prints_as_a_file() {
        assert_eq!(
            tree().file(),
            "(\n    title: \"a \\\"test\\\"\",\n    size: (8, 9.5, 1),\n    \
             shape: Union([Sphere(radius: 2), Sphere(radius: 3)]),\n    sun: None,\n)\n"
        );
    }

    #[test]
    fn steps_reach_every_part_and_make_the_tree_simpler() {
        let tree = tree();
        let after: Vec<String> = tree
            .steps()
            .iter()
            .filter_map(|step| tree.after(step))
            .map(|tree| tree.to_string())
            .collect();
        for expected in [
            "(size: (8, 9.5, 1), shape: Union([Sphere(radius: 2), Sphere(radius: 3)]), sun: None)",
            "(title: \"a \\\"test\\\"\", size: (8, 9.5, 1), shape: Sphere(radius: 3), sun: None)",
            "(title: \"a \\\"test\\\"\", size: (8, 9.5, 1), shape: Union([Sphere(radius: 3)]), sun: None)",
            "(title: \"a \\\"test\\\"\", size: (4, 9.5, 1), shape: Union([Sphere(radius: 2), Sphere(radius: 3)]), sun: None)",
        ] {
            assert!(
                after.iter().any(|text| text == expected),
                "{expected}\n{after:#?}"
            );
        }
        assert!(
            !after.contains(&tree.to_string()),
            "every step changes something"
        );
    }

    #[test]
    fn steps_come_to_an_end() {
        let mut tree = tree();
        let mut taken = 0;
        while let Some(next) = tree.steps().first().and_then(|step| tree.after(step)) {
            assert!(next.nodes() <= tree.nodes());
            tree = next;
            taken += 1;
            assert!(taken < 100);
        }
        assert_eq!(tree, Term::Record("", Vec::new()));
    }
}

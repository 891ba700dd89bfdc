//! Names of screenshots, from the time when they were taken.

use std::{
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

/// `grotto-YYYYMMDD-HHMMSS-N.png` in `folder`, in Universal Time, with the first N that is free.
pub fn free_name(folder: &Path, now: SystemTime) -> PathBuf {
    let since_1970 = now
        .duration_since(SystemTime::UNIX_EPOCH)
        .unwrap_or_default();
    let stem = format!("grotto-{}", stamp(since_1970));
    (1u32..)
        .map(|number| folder.join(format!("{stem}-{number}.png")))
        .find(|path| !path.exists())
        .expect("no folder holds so many screenshots of one second")
}

/// `YYYYMMDD-HHMMSS` of a time after 1970.
fn stamp(since_1970: Duration) -> String {
    let seconds = since_1970.as_secs();
    let (year, month, day) = civil(seconds / 86400);
    let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    format!("{year:04}{month:02}{day:02}-{hour:02}{minute:02}{second:02}")
}

/// Year, month and day of a number of days since 1970-01-01 (Hinnant 2013, "chrono-compatible
/// low-level date algorithms", `civil_from_days`, for days after 1970 alone).
fn civil(days: u64) -> (u64, u64, u64) {
    // The year starts in March here, so that a leap day is its last day.
    let days = days + 719_468;
    let era = days / 146_097;
    let day_of_era = days % 146_097;
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let months_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * months_from_march + 2) / 5 + 1;
    let month = if months_from_march < 10 {
        months_from_march + 3
    } else {
        months_from_march - 9
    };
    (year_of_era + era * 400 + u64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against `date -u -d @SECONDS +%Y%m%d-%H%M%S`.
    #[test]
    fn stamps_of_known_times() {
        for (seconds, expected) in [
            (0, "19700101-000000"),
            (951_782_399, "20000228-235959"),
            (951_782_400, "20000229-000000"),
            (1_709_251_199, "20240229-235959"),
            (1_735_689_599, "20241231-235959"),
            (4_107_542_400, "21000301-000000"),
        ] {
            assert_eq!(stamp(Duration::from_secs(seconds)), expected);
        }
    }

    #[test]
    fn names_are_free() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let now = SystemTime::UNIX_EPOCH;
        let first = free_name(folder.path(), now);
        assert!(first.ends_with("grotto-19700101-000000-1.png"));
        std::fs::write(&first, "").expect("writable");
        assert!(free_name(folder.path(), now).ends_with("grotto-19700101-000000-2.png"));
    }
}

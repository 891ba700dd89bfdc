//! The kinds of storms, and which of them run at the same time.

use std::fmt;

/// What changes while frames are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Voxels.
    Edit,
    /// The probes' layout and the parameters that rebuild the probes.
    Layout,
    /// The size of the picture.
    Resize,
    /// World time jumps.
    Time,
    /// The device is destroyed and opened again.
    Loss,
    /// Mixed changes over a long time.
    Soak,
}

impl Kind {
    pub const ALL: [Self; 6] = [
        Self::Edit,
        Self::Layout,
        Self::Resize,
        Self::Time,
        Self::Loss,
        Self::Soak,
    ];

    /// The flag that selects the kind, without its dashes.
    pub fn flag(self) -> &'static str {
        match self {
            Self::Edit => "edit-storm",
            Self::Layout => "layout-storm",
            Self::Resize => "resize-storm",
            Self::Time => "time-storm",
            Self::Loss => "device-loss",
            Self::Soak => "soak",
        }
    }
}

/// Kinds that run at the same time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kinds(Vec<Kind>);

impl Kinds {
    /// Each kind once, in the order of [`Kind::ALL`].
    pub fn new(kinds: &[Kind]) -> Self {
        let wanted = Kind::ALL.into_iter().filter(|kind| kinds.contains(kind));
        Self(wanted.collect())
    }

    pub fn has(&self, kind: Kind) -> bool {
        self.0.contains(&kind)
    }

    /// Whether `kind` is the only one.
    pub fn only(&self, kind: Kind) -> bool {
        self.0 == [kind]
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn iter(&self) -> impl Iterator<Item = Kind> + '_ {
        self.0.iter().copied()
    }
}

impl fmt::Display for Kinds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let flags: Vec<&str> = self.iter().map(Kind::flag).collect();
        f.write_str(&flags.join("+"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_there_once_in_one_order() {
        let kinds = Kinds::new(&[Kind::Loss, Kind::Edit, Kind::Loss]);
        assert_eq!(kinds.to_string(), "edit-storm+device-loss");
        assert!(kinds.has(Kind::Loss) && !kinds.has(Kind::Time));
        assert!(!kinds.only(Kind::Edit) && Kinds::new(&[Kind::Soak]).only(Kind::Soak));
        assert!(Kinds::new(&[]).is_empty());
    }
}

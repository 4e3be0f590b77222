//! What an OBJ file says that a triangle mesh does not.

use std::fmt;

/// Something in an OBJ file that was left out or replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjWarning {
    /// What it is.
    pub kind: ObjWarningKind,
    /// How often it occurs.
    pub count: u64,
    /// The line where it occurs first, counted from one.
    pub first_line: u64,
}

/// The classes of [`ObjWarning`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ObjWarningKind {
    /// Points (`p`) and polylines (`l`) were left out.
    PointOrLine,
    /// Curves and surfaces (`curv`, `surf`, `vp` and their kin) were left out.
    FreeForm,
    /// Colours or weights after the coordinates of a position were left out.
    VertexColor,
    /// Faces with fewer than three corners were left out.
    DegenerateFace,
    /// Normals without a direction were replaced by computed ones.
    UnusableNormal,
    /// There are several materials (`usemtl`), but the mesh has one.
    SeveralMaterials,
    /// Statements that OBJ does not have were left out.
    UnknownStatement,
}

impl ObjWarningKind {
    /// Every kind, in the order in which they are reported.
    pub(crate) const ALL: [Self; 7] = [
        Self::PointOrLine,
        Self::FreeForm,
        Self::VertexColor,
        Self::DegenerateFace,
        Self::UnusableNormal,
        Self::SeveralMaterials,
        Self::UnknownStatement,
    ];

    fn description(self) -> &'static str {
        match self {
            Self::PointOrLine => "points or lines were left out",
            Self::FreeForm => "curves or surfaces were left out",
            Self::VertexColor => "vertex colours or weights were left out",
            Self::DegenerateFace => "faces with fewer than three corners were left out",
            Self::UnusableNormal => "normals without a direction were replaced by computed ones",
            Self::SeveralMaterials => "materials are named, but the mesh has a single one",
            Self::UnknownStatement => "unknown statements were left out",
        }
    }
}

impl fmt::Display for ObjWarning {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, count, first_line } = self;
        write!(formatter, "line {first_line}: {count} {}", kind.description())
    }
}

/// How often each kind was met, and where first.
#[derive(Default)]
pub(crate) struct Tally([(u64, u64); ObjWarningKind::ALL.len()]);

impl Tally {
    /// Counts one more at `line`.
    pub(crate) fn count(&mut self, kind: ObjWarningKind, line: u64) {
        let (count, first_line) = &mut self.0[kind as usize];
        if *count == 0 {
            *first_line = line;
        }
        *count += 1;
    }

    /// How many there were.
    pub(crate) fn of(&self, kind: ObjWarningKind) -> u64 {
        self.0[kind as usize].0
    }

    /// The warnings of all that were met. One material is none too many.
    pub(crate) fn warnings(&self) -> Vec<ObjWarning> {
        let warning = |kind: ObjWarningKind| {
            let (count, first_line) = self.0[kind as usize];
            let tolerated = u64::from(kind == ObjWarningKind::SeveralMaterials);
            (count > tolerated).then_some(ObjWarning { kind, count, first_line })
        };
        ObjWarningKind::ALL.into_iter().filter_map(warning).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_reads_as_a_sentence_with_its_first_line() {
        let mut tally = Tally::default();
        tally.count(ObjWarningKind::UnknownStatement, 9);
        tally.count(ObjWarningKind::UnknownStatement, 11);
        tally.count(ObjWarningKind::SeveralMaterials, 2);
        let texts: Vec<String> = tally.warnings().iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["line 9: 2 unknown statements were left out"]);
    }
}

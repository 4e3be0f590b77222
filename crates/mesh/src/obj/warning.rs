//! Warnings about parts of an OBJ file that a triangle mesh cannot represent.

use std::fmt;

/// Something in an OBJ file that was ignored or replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjWarning {
    /// The class of the warning.
    pub kind: ObjWarningKind,
    /// The number of occurrences.
    pub count: u64,
    /// The line of the first occurrence, starting at one.
    pub first_line: u64,
}

/// The classes of [`ObjWarning`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ObjWarningKind {
    /// Points (`p`) and polylines (`l`) were ignored.
    PointOrLine,
    /// Curves and surfaces (`curv`, `surf`, `vp` and related statements) were ignored.
    FreeForm,
    /// Colours or weights after the coordinates of a position were ignored.
    VertexColor,
    /// Faces with fewer than three corners were ignored.
    DegenerateFace,
    /// Zero or non-finite normals were replaced by computed ones.
    UnusableNormal,
    /// Texture coordinates that are not finite were replaced by (0, 0).
    UnusableUv,
    /// Indices of texture coordinates or normals that do not exist were ignored.
    DanglingIndex,
    /// There are several materials (`usemtl`), but the mesh has one.
    SeveralMaterials,
    /// Statements that are not part of OBJ were ignored.
    UnknownStatement,
}

impl ObjWarningKind {
    /// All kinds, in the order in which they are reported.
    pub(crate) const ALL: [Self; 9] = [
        Self::PointOrLine,
        Self::FreeForm,
        Self::VertexColor,
        Self::DegenerateFace,
        Self::UnusableNormal,
        Self::UnusableUv,
        Self::DanglingIndex,
        Self::SeveralMaterials,
        Self::UnknownStatement,
    ];

    fn description(self) -> &'static str {
        match self {
            Self::PointOrLine => "points or lines were ignored",
            Self::FreeForm => "curves or surfaces were ignored",
            Self::VertexColor => "vertex colours or weights were ignored",
            Self::DegenerateFace => "faces with fewer than three corners were ignored",
            Self::UnusableNormal => "normals without a direction were replaced by computed ones",
            Self::UnusableUv => "texture coordinates that are not finite were replaced by (0, 0)",
            Self::DanglingIndex => {
                "indices of texture coordinates or normals that do not exist were ignored"
            }
            Self::SeveralMaterials => "materials are used, but the mesh has only one",
            Self::UnknownStatement => "unknown statements were ignored",
        }
    }
}

impl fmt::Display for ObjWarning {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, count, first_line } = self;
        write!(formatter, "line {first_line}: {count} {}", kind.description())
    }
}

/// The number of occurrences of each kind, and the line of the first.
#[derive(Default)]
pub(crate) struct Tally([(u64, u64); ObjWarningKind::ALL.len()]);

impl Tally {
    /// Counts one more occurrence, at `line`.
    pub(crate) fn count(&mut self, kind: ObjWarningKind, line: u64) {
        let (count, first_line) = &mut self.0[kind as usize];
        if *count == 0 {
            *first_line = line;
        }
        *count += 1;
    }

    /// The number of occurrences of a kind.
    pub(crate) fn of(&self, kind: ObjWarningKind) -> u64 {
        self.0[kind as usize].0
    }

    /// The warnings for all kinds that occurred. A single material is not worth one.
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
    fn a_warning_is_a_sentence_with_its_first_line() {
        let mut tally = Tally::default();
        tally.count(ObjWarningKind::UnknownStatement, 9);
        tally.count(ObjWarningKind::UnknownStatement, 11);
        tally.count(ObjWarningKind::SeveralMaterials, 2);
        let texts: Vec<String> = tally.warnings().iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["line 9: 2 unknown statements were ignored"]);
    }
}

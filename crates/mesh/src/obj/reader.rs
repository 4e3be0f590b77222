//! Reads the statements of an OBJ file.

use super::options::{ObjMesh, ObjOptions};
use super::warning::{ObjWarningKind, Tally};
use super::weld::{Corner, NONE, Weld};
use crate::error::{MeshError, MeshErrorKind};
use crate::polygon::triangulate;
use crate::text::TextCursor;
use crate::triangle_mesh::{TriangleMesh, check_vertex_count};
use glam::{Vec2, Vec3};

/// The statements that a pass reads.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Statements {
    /// All statements: suffices if faces come after their vertices.
    All,
    /// All but faces.
    Vertices,
    /// Only faces, after a pass over the vertices. Other statements are counted.
    Faces,
}

/// The statements that hold names up to the end of the line.
const NAMED: [&[u8]; 6] = [b"usemtl", b"mtllib", b"usemap", b"maplib", b"g", b"o"];

/// The three lists that faces refer to.
#[derive(Clone, Copy)]
enum List {
    Positions,
    Uvs,
    Normals,
}

impl List {
    /// The name of one element in messages.
    fn noun(self) -> &'static str {
        match self {
            Self::Positions => "position",
            Self::Uvs => "texture coordinate",
            Self::Normals => "normal",
        }
    }
}

/// The state of the reader.
pub(super) struct Reader {
    statements: Statements,
    name: Option<String>,
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    /// The number of elements of each [`List`] that this pass has seen: the base of negative
    /// indices.
    seen: [usize; 3],
    weld: Weld,
    /// The vertices of the current face; kept to reuse the memory.
    polygon: Vec<u32>,
    indices: Vec<[u32; 3]>,
    tally: Tally,
    refers_ahead: bool,
}

impl Reader {
    pub(super) fn new() -> Self {
        Self {
            statements: Statements::All,
            name: None,
            positions: Vec::new(),
            uvs: Vec::new(),
            normals: Vec::new(),
            seen: [0; 3],
            weld: Weld::default(),
            polygon: Vec::new(),
            indices: Vec::new(),
            tally: Tally::default(),
            refers_ahead: false,
        }
    }

    /// Whether the last pass stopped at an index that may refer to a later vertex.
    pub(super) fn refers_ahead(&self) -> bool {
        self.refers_ahead
    }

    /// Makes one pass over the file.
    pub(super) fn read(&mut self, bytes: &[u8], statements: Statements) -> Result<(), MeshError> {
        self.statements = statements;
        self.seen = [0; 3];
        let mut cursor = TextCursor::new(bytes);
        while !cursor.is_at_end() {
            cursor.skip_blanks();
            self.read_statement(&mut cursor)?;
            cursor.skip_blanks();
            if !cursor.is_at_statement_end() {
                return Err(cursor.expected("the end of the line"));
            }
            if cursor.peek() == Some(b'#') {
                cursor.skip_statement();
            }
            cursor.take_line_end();
        }
        Ok(())
    }

    /// Reads one statement up to its end, or to a comment.
    #[inline]
    fn read_statement(&mut self, cursor: &mut TextCursor<'_>) -> Result<(), MeshError> {
        if cursor.is_at_statement_end() {
            return Ok(());
        }
        let keyword = cursor.word();
        cursor.skip_blanks();
        match (keyword, self.statements) {
            (b"f", Statements::All | Statements::Faces) => return self.read_face(cursor),
            (b"v", Statements::All | Statements::Vertices) => return self.read_position(cursor),
            (b"vn", Statements::All | Statements::Vertices) => return self.read_normal(cursor),
            (b"vt", Statements::All | Statements::Vertices) => return self.read_uv(cursor),
            (b"v", Statements::Faces) => self.seen[List::Positions as usize] += 1,
            (b"vt", Statements::Faces) => self.seen[List::Uvs as usize] += 1,
            (b"vn", Statements::Faces) => self.seen[List::Normals as usize] += 1,
            (b"f", Statements::Vertices) | (_, Statements::Faces) => {}
            (_, Statements::All | Statements::Vertices) => self.note_other(keyword, cursor),
        }
        if NAMED.contains(&keyword) {
            // A backslash at the end is part of a name, such as that of a folder.
            cursor.rest_of_line();
        } else {
            cursor.skip_statement();
        }
        Ok(())
    }

    #[inline]
    fn read_position(&mut self, cursor: &mut TextCursor<'_>) -> Result<(), MeshError> {
        let position = read_vector(cursor, "a coordinate of a position")?;
        if !position.is_finite() {
            return Err(not_finite(cursor));
        }
        if !cursor.is_at_statement_end() {
            self.tally.count(ObjWarningKind::VertexColor, cursor.line());
            while !cursor.is_at_statement_end() {
                cursor.float("a weight or colour after a position")?;
            }
        }
        self.positions.push(position);
        self.seen[List::Positions as usize] += 1;
        check_vertex_count(self.positions.len() as u64)
    }

    /// A normal that is not finite is treated like a zero normal: some exporters divide by the
    /// length of degenerate faces, and the rest of such a file is usable.
    #[inline]
    fn read_normal(&mut self, cursor: &mut TextCursor<'_>) -> Result<(), MeshError> {
        let mut normal = read_vector(cursor, "a coordinate of a normal")?;
        if !normal.is_finite() || normal == Vec3::ZERO {
            normal = Vec3::ZERO;
            self.tally.count(ObjWarningKind::UnusableNormal, cursor.line());
        }
        self.normals.push(normal);
        self.seen[List::Normals as usize] += 1;
        check_vertex_count(self.normals.len() as u64)
    }

    #[inline]
    fn read_uv(&mut self, cursor: &mut TextCursor<'_>) -> Result<(), MeshError> {
        const WHAT: &str = "a texture coordinate";
        let mut uv = Vec2::new(cursor.float(WHAT)?, 0.0);
        if !cursor.is_at_statement_end() {
            uv.y = cursor.float(WHAT)?;
        }
        if !cursor.is_at_statement_end() {
            cursor.float(WHAT)?;
        }
        if !uv.is_finite() {
            uv = Vec2::ZERO;
            self.tally.count(ObjWarningKind::UnusableUv, cursor.line());
        }
        self.uvs.push(uv);
        self.seen[List::Uvs as usize] += 1;
        check_vertex_count(self.uvs.len() as u64)
    }

    #[inline]
    fn read_face(&mut self, cursor: &mut TextCursor<'_>) -> Result<(), MeshError> {
        self.polygon.clear();
        while !cursor.is_at_statement_end() {
            let corner = self.read_corner(cursor)?;
            let vertex = self.weld.vertex(corner, self.positions.len())?;
            self.polygon.push(vertex);
            cursor.skip_blanks();
        }
        if self.polygon.len() < 3 {
            self.tally.count(ObjWarningKind::DegenerateFace, cursor.line());
        }
        let (weld, positions) = (&self.weld, &self.positions);
        let position_of = |vertex| {
            let corner = weld.corner(vertex)?;
            positions.get(corner.position as usize).copied()
        };
        triangulate(&self.polygon, position_of, &mut self.indices);
        Ok(())
    }

    /// One corner: `v`, `v/vt`, `v//vn`, `v/vt/vn`; also `v/` and `v//`, which some exporters
    /// write.
    #[inline(always)]
    fn read_corner(&mut self, cursor: &mut TextCursor<'_>) -> Result<Corner, MeshError> {
        let common_count = self.positions.len().min(self.uvs.len()).min(self.normals.len());
        if let Some((written, length)) = cursor.peek_short_integer()
            && cursor.is_index_triple(length)
            && (1..=common_count).contains(&(written as usize))
        {
            cursor.advance(TextCursor::triple_length(length));
            let index = written - 1;
            return Ok(Corner { position: index, uv: index, normal: index });
        }
        let position = self.read_index(cursor, List::Positions)?;
        let mut corner = Corner { position, uv: NONE, normal: NONE };
        if cursor.peek() == Some(b'/') {
            cursor.advance(1);
            if starts_index(cursor) {
                corner.uv = self.read_optional_index(cursor, List::Uvs)?;
            }
            if cursor.peek() == Some(b'/') {
                cursor.advance(1);
                if starts_index(cursor) {
                    corner.normal = self.read_optional_index(cursor, List::Normals)?;
                }
            }
        }
        match cursor.peek() {
            None | Some(b' ' | b'\t' | b'\n' | b'\r' | b'\\' | b'#') => Ok(corner),
            _ => Err(cursor.expected("a blank after the corner of a face")),
        }
    }

    /// Reads a valid index into `list`, and converts it to start at zero.
    #[inline(always)]
    fn read_index(&mut self, cursor: &mut TextCursor<'_>, list: List) -> Result<u32, MeshError> {
        if let Some((written, length)) = cursor.peek_short_integer()
            && (1..=self.count(list)).contains(&(written as usize))
        {
            cursor.advance(length);
            return Ok(written - 1);
        }
        self.read_any_index(cursor, list)
    }

    /// Reads an index of a texture coordinate or a normal; [`NONE`] if it refers to nothing, because
    /// the rest of such a file is usable.
    #[inline(always)]
    fn read_optional_index(
        &mut self,
        cursor: &mut TextCursor<'_>,
        list: List,
    ) -> Result<u32, MeshError> {
        let line = cursor.line();
        match self.read_index(cursor, list) {
            Err(error) if error.kind == MeshErrorKind::OutOfRange && !self.refers_ahead => {
                self.tally.count(ObjWarningKind::DanglingIndex, line);
                Ok(NONE)
            }
            result => result,
        }
    }

    /// [`Reader::read_index`] for every notation.
    #[inline(never)]
    fn read_any_index(
        &mut self,
        cursor: &mut TextCursor<'_>,
        list: List,
    ) -> Result<u32, MeshError> {
        let written = cursor.integer("an index")?;
        let seen = self.seen[list as usize];
        let index = match written {
            1.. => (written - 1) as u64,
            // Before the first element, this wraps around to a number that is out of range.
            ..0 => (seen as u64).wrapping_add_signed(written),
            0 => return Err(self.out_of_range(cursor, list, written)),
        };
        if index < self.count(list) as u64 {
            return Ok(index as u32);
        }
        self.refers_ahead = self.statements == Statements::All && written > 0;
        Err(self.out_of_range(cursor, list, written))
    }

    #[inline]
    fn count(&self, list: List) -> usize {
        match list {
            List::Positions => self.positions.len(),
            List::Uvs => self.uvs.len(),
            List::Normals => self.normals.len(),
        }
    }

    #[cold]
    fn out_of_range(&self, cursor: &TextCursor<'_>, list: List, written: i64) -> MeshError {
        let noun = list.noun();
        let message = match written {
            0 => format!("{noun} index 0 is not valid: indices start at 1"),
            ..0 => {
                let seen = self.seen[list as usize];
                format!("{noun} index {written} is out of range: {seen} {noun}s come before it")
            }
            _ => {
                let count = self.count(list);
                format!("{noun} index {written} is out of range: there are {count} {noun}s")
            }
        };
        cursor.error(MeshErrorKind::OutOfRange, message)
    }

    /// Counts statements that are neither vertices nor faces and have no effect, and keeps the name
    /// of the first object.
    fn note_other(&mut self, keyword: &[u8], cursor: &mut TextCursor<'_>) {
        let line = cursor.line();
        match keyword {
            b"o" => {
                let name = cursor.rest_of_line().trim_ascii();
                self.name.get_or_insert_with(|| String::from_utf8_lossy(name).into_owned());
            }
            b"p" | b"l" => self.tally.count(ObjWarningKind::PointOrLine, line),
            b"usemtl" => self.tally.count(ObjWarningKind::SeveralMaterials, line),
            b"g" | b"s" | b"mg" | b"mtllib" | b"usemap" | b"maplib" | b"bevel" | b"c_interp"
            | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj" => {}
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf"
            | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"ctech"
            | b"stech" => self.tally.count(ObjWarningKind::FreeForm, line),
            _ => self.tally.count(ObjWarningKind::UnknownStatement, line),
        }
    }

    /// Assembles the mesh.
    pub(super) fn finish(mut self, options: &ObjOptions) -> Result<ObjMesh, MeshError> {
        let is_empty = self.positions.is_empty() && self.indices.is_empty();
        if is_empty && self.tally.of(ObjWarningKind::UnknownStatement) > 0 {
            return Err(MeshError::new(
                MeshErrorKind::Syntax,
                "this is not an OBJ file: it has no vertices or faces, but unknown statements",
            ));
        }
        self.indices.shrink_to_fit();
        let mut mesh = TriangleMesh {
            name: self.name.unwrap_or_default(),
            indices: self.indices,
            ..Default::default()
        };
        {
            let weld = self.weld.seal();
            let corners = weld.corners();
            // One list after another, so that each source is freed before the next list grows.
            mesh.positions = gather(self.positions, corners.clone().map(|corner| corner.position));
            mesh.uvs = gather(self.uvs, corners.clone().map(|corner| corner.uv));
            mesh.normals = gather(self.normals, corners.clone().map(|corner| corner.normal));
            if options.flip_texture_coordinates {
                for (uv, corner) in mesh.uvs.iter_mut().zip(corners) {
                    if corner.uv != NONE {
                        uv.y = 1.0 - uv.y;
                    }
                }
            }
        }
        mesh.fill_missing_normals();
        Ok(ObjMesh { mesh, warnings: self.tally.warnings() })
    }
}

/// The elements of `list` at `picks`, with zero for [`NONE`]; empty if all picks are [`NONE`].
/// Reuses the list if the picks are its elements in order.
fn gather<T: Copy + Default>(mut list: Vec<T>, picks: impl Iterator<Item = u32> + Clone) -> Vec<T> {
    let in_order = picks.clone().zip(0..).take_while(|&(pick, place)| pick == place).count();
    let pick_count = picks.clone().count();
    if in_order == pick_count && list.len() >= pick_count {
        list.truncate(pick_count);
        list.shrink_to_fit();
        return list;
    }
    if picks.clone().all(|pick| pick == NONE) {
        return Vec::new();
    }
    let mut gathered = Vec::with_capacity(pick_count);
    gathered.extend(picks.map(|pick| list.get(pick as usize).copied().unwrap_or_default()));
    gathered
}

#[inline]
fn read_vector(cursor: &mut TextCursor<'_>, what: &str) -> Result<Vec3, MeshError> {
    Ok(Vec3::new(cursor.float(what)?, cursor.float(what)?, cursor.float(what)?))
}

#[inline]
fn starts_index(cursor: &TextCursor<'_>) -> bool {
    matches!(cursor.peek(), Some(b'0'..=b'9' | b'-' | b'+'))
}

#[cold]
fn not_finite(cursor: &TextCursor<'_>) -> MeshError {
    let message = "this position is not finite in single precision";
    cursor.error(MeshErrorKind::NonFinite, message)
}

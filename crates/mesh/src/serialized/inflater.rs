//! Reads numbers from the zlib stream of a shape.

use crate::error::{MeshError, MeshErrorKind};
use flate2::bufread::ZlibDecoder;
use std::io::{BufReader, ErrorKind, Read};

/// The number of bytes inflated at a time.
const CHUNK_SIZE: usize = 1 << 16;

/// The maximum expansion by Deflate: a match of 258 bytes takes at least two bits.
const MAX_RATIO: u128 = 1032;

/// Longer names are considered corrupt.
const MAX_NAME_LENGTH: usize = 1 << 16;

/// Inflates a stream in pieces. Memory grows with the actual output, never with announced counts.
pub(super) struct Inflater<'a> {
    reader: BufReader<ZlibDecoder<&'a [u8]>>,
    compressed_size: usize,
    offset: usize,
}

impl<'a> Inflater<'a> {
    /// The stream at the start of `compressed`, at `offset` in its file.
    pub(super) fn new(compressed: &'a [u8], offset: usize) -> Self {
        let decoder = ZlibDecoder::new(compressed);
        let reader = BufReader::with_capacity(CHUNK_SIZE, decoder);
        Self { reader, compressed_size: compressed.len(), offset }
    }

    /// Rejects a size that the stream cannot possibly hold.
    pub(super) fn check_room(&self, size: u128) -> Result<(), MeshError> {
        if size <= self.compressed_size as u128 * MAX_RATIO {
            // Vectors that find no memory end the process, so this asks for it and gives it back.
            let bytes = usize::try_from(size).unwrap_or(usize::MAX);
            return Vec::<u8>::new().try_reserve_exact(bytes).map_err(|_| {
                let message = format!("no memory for the {size} bytes that the shape announces");
                self.error(MeshErrorKind::Limit, message)
            });
        }
        Err(self.error(
            MeshErrorKind::Truncated,
            format!(
                "the shape announces {size} bytes, which {} compressed bytes cannot hold",
                self.compressed_size
            ),
        ))
    }

    pub(super) fn u32(&mut self) -> Result<u32, MeshError> {
        let mut bytes = [0; 4];
        self.fill(&mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }

    pub(super) fn u64(&mut self) -> Result<u64, MeshError> {
        let mut bytes = [0; 8];
        self.fill(&mut bytes)?;
        Ok(u64::from_le_bytes(bytes))
    }

    /// A zero-terminated string.
    pub(super) fn name(&mut self) -> Result<String, MeshError> {
        let mut name = Vec::new();
        loop {
            let mut byte = [0];
            self.fill(&mut byte)?;
            if byte == [0] {
                return Ok(String::from_utf8_lossy(&name).into_owned());
            }
            if name.len() == MAX_NAME_LENGTH {
                return Err(self.error(
                    MeshErrorKind::Limit,
                    format!("the name of the shape is longer than {MAX_NAME_LENGTH} bytes"),
                ));
            }
            name.extend(byte);
        }
    }

    /// Reads rows of `COUNT` numbers of `SIZE` bytes each.
    pub(super) fn array<T, const SIZE: usize, const COUNT: usize>(
        &mut self,
        row_count: u64,
        convert: impl Fn([[u8; SIZE]; COUNT]) -> T,
    ) -> Result<Vec<T>, MeshError> {
        let rows_at_a_time = CHUNK_SIZE / (SIZE * COUNT);
        let mut chunk = vec![0; rows_at_a_time * SIZE * COUNT];
        let mut rows = Vec::new();
        let mut left = row_count;
        while left > 0 {
            let now = usize::try_from(left).map_or(rows_at_a_time, |left| left.min(rows_at_a_time));
            let bytes = &mut chunk[..now * SIZE * COUNT];
            self.fill(bytes)?;
            if rows.len() + now > rows.capacity() {
                // Doubles the capacity, up to what will be needed.
                let needed = usize::try_from(left).unwrap_or(usize::MAX);
                rows.reserve_exact(needed.min(now.max(rows.len())));
            }
            let numbers = bytes.as_chunks::<SIZE>().0;
            rows.extend(numbers.as_chunks::<COUNT>().0.iter().map(|&row| convert(row)));
            left -= now as u64;
        }
        Ok(rows)
    }

    /// Verifies the checksum, if the stream ends here. Any further data is ignored.
    pub(super) fn check_sum(&mut self) -> Result<(), MeshError> {
        // The decoder verifies the checksum when a read reaches the end of the stream.
        let further = self.reader.read(&mut [0]);
        further.map(|_| ()).map_err(|error| self.corrupt(&error))
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), MeshError> {
        self.reader.read_exact(bytes).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => {
                self.error(MeshErrorKind::Truncated, "the shape ends early".to_owned())
            }
            _ => self.corrupt(&error),
        })
    }

    fn corrupt(&self, error: &std::io::Error) -> MeshError {
        let message = format!("the compressed data of the shape is corrupt ({error})");
        self.error(MeshErrorKind::Syntax, message)
    }

    fn error(&self, kind: MeshErrorKind, message: String) -> MeshError {
        MeshError::new(kind, message).at_offset(self.offset)
    }
}

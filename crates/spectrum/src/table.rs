//! Parses tables of numbers at compile time, so that a malformed data file fails the build.

/// Parses a text table: one row per line, numbers separated by spaces, comments in lines that start
/// with `#`.
///
/// # Panics
///
/// If the text does not have exactly `ROWS` rows of `COLUMNS` numbers. For constants, this is a
/// compile-time error.
pub(crate) const fn parse_table<const ROWS: usize, const COLUMNS: usize>(
    text: &str,
) -> [[f64; COLUMNS]; ROWS] {
    let bytes = text.as_bytes();
    let mut table = [[0.0; COLUMNS]; ROWS];
    let mut position = 0;
    let mut row = 0;
    while position < bytes.len() {
        if bytes[position] == b'#' {
            position = end_of_line(bytes, position);
        } else {
            let mut column = 0;
            while column < COLUMNS {
                (table[row][column], position) = parse_decimal(bytes, position);
                let separator = if column + 1 == COLUMNS { b'\n' } else { b' ' };
                assert!(bytes[position] == separator, "a row has the wrong number of columns");
                position += 1;
                column += 1;
            }
            row += 1;
        }
    }
    assert!(row == ROWS, "the table has the wrong number of rows");
    table
}

/// The start of the line after the one at `position`.
const fn end_of_line(bytes: &[u8], mut position: usize) -> usize {
    while bytes[position] != b'\n' {
        position += 1;
    }
    position + 1
}

/// The unsigned decimal number at `position`, and its end. Its digits as an integer stay below 2⁵³
/// and the power of ten below 10²², so that one division is correctly rounded.
const fn parse_decimal(bytes: &[u8], mut position: usize) -> (f64, usize) {
    let mut digits: u64 = 0;
    let mut divisor: u64 = 1;
    let mut is_fraction = false;
    let begin = position;
    while bytes[position].is_ascii_digit() || bytes[position] == b'.' {
        if bytes[position] == b'.' {
            is_fraction = true;
        } else {
            digits = digits * 10 + (bytes[position] - b'0') as u64;
            divisor = if is_fraction { divisor * 10 } else { divisor };
        }
        position += 1;
    }
    assert!(position > begin, "not a number");
    assert!(digits < 1 << 53, "more digits than a double can represent");
    (digits as f64 / divisor as f64, position)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_comments_are_read() {
        const TABLE: [[f64; 2]; 2] = parse_table("# comment\n360 0.0001299\n365.5 10\n");
        assert_eq!(TABLE, [[360.0, 0.0001299], [365.5, 10.0]]);
    }

    #[test]
    #[should_panic(expected = "columns")]
    fn a_missing_column_is_rejected() {
        parse_table::<1, 2>("1\n2\n");
    }

    #[test]
    #[should_panic(expected = "rows")]
    fn a_missing_row_is_rejected() {
        parse_table::<2, 1>("1\n");
    }
}

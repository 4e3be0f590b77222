//! How much memory the machine has to give.

/// The bytes that can be taken without swapping; `None` where the system does not tell.
pub(crate) fn available() -> Option<u64> {
    parse_meminfo(&std::fs::read_to_string("/proc/meminfo").ok()?)
}

/// The line `MemAvailable: 123 kB` of Linux' `/proc/meminfo`.
fn parse_meminfo(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_available_memory_is_read() {
        let text = "MemTotal:  8000 kB\nMemAvailable:   1234 kB\n";
        assert_eq!(parse_meminfo(text), Some(1234 * 1024));
        assert_eq!(parse_meminfo("MemTotal: 5 kB"), None);
        assert_eq!(parse_meminfo("MemAvailable: many kB"), None);
    }
}

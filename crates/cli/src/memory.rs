//! Available and used memory.

use std::fs::read_to_string;

/// The bytes that this process can allocate without swapping and without reaching a limit set by a
/// shell (`ulimit -v`) or a container; `None` if the system does not report it.
pub(crate) fn available() -> Option<u64> {
    let read = |path: &str| read_to_string(path).ok();
    let physical = read("/proc/meminfo").and_then(|text| kilobytes(&text, "MemAvailable:"));
    let address_space = read("/proc/self/limits").and_then(|limits| {
        let used = kilobytes(&read("/proc/self/status")?, "VmSize:")?;
        Some(address_space_limit(&limits)?.saturating_sub(used))
    });
    let container = |folder: &str| {
        let limit = bytes(&read(&format!("{folder}/memory.max"))?)?;
        Some(limit.saturating_sub(bytes(&read(&format!("{folder}/memory.current"))?)?))
    };
    let root = container("/sys/fs/cgroup");
    let own = read("/proc/self/cgroup").and_then(|groups| container(&control_group(&groups)?));
    [physical, address_space, root, own].into_iter().flatten().min()
}

/// The memory that the files of a scene may take together: most of what is available. The rest is for
/// the film, the threads and what cannot be foreseen.
pub(crate) fn for_scene() -> Option<u64> {
    available().map(|bytes| bytes / 10 * 9)
}

/// The folder of the process's own control group, of the second version: the line `0::/path`.
fn control_group(groups: &str) -> Option<String> {
    let path = groups.lines().find_map(|line| line.strip_prefix("0::"))?;
    Some(format!("/sys/fs/cgroup{}", path.trim_end_matches('/')))
}

/// The most bytes that this process has occupied so far; `None` if the system does not report it.
pub(crate) fn peak() -> Option<u64> {
    kilobytes(&read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// The value of a line such as `MemAvailable: 123 kB` in Linux's `/proc/meminfo`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// The soft limit of the line `Max address space  123  unlimited  bytes`, if there is one.
fn address_space_limit(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// The number in a file of one number; `None` for the word `max`, which means no limit.
fn bytes(text: &str) -> Option<u64> {
    text.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_available_memory_is_read() {
        let text = "MemTotal:  8000 kB\nMemAvailable:   1234 kB\n";
        assert_eq!(kilobytes(text, "MemAvailable:"), Some(1234 * 1024));
        assert_eq!(kilobytes("MemTotal: 5 kB", "MemAvailable:"), None);
        assert_eq!(kilobytes("MemAvailable: many kB", "MemAvailable:"), None);
    }

    #[test]
    fn limits_are_read() {
        let limits =
            "Limit  Soft Limit  Hard Limit  Units\nMax address space  4096  unlimited  bytes";
        assert_eq!(address_space_limit(limits), Some(4096));
        assert_eq!(address_space_limit("Max address space  unlimited  unlimited  bytes"), None);
        assert_eq!((bytes("12\n"), bytes("max\n")), (Some(12), None));
        let folder = control_group("1:cpu:/x\n0::/user.slice/a\n");
        assert_eq!(folder.as_deref(), Some("/sys/fs/cgroup/user.slice/a"));
    }
}

//! `cargo xtask bench scale`: rate and memory by the number of triangles and of instances, for the
//! tree alone and for whole renders. Two memory limits must hold.

use clap::Parser;
use serde_json::{Value, json};

use super::generated::{self, Kind};
use super::keep::{self, SavedRun};
use super::process::{self, Figures, Job};
use crate::etendue;
use crate::workspace::cargo;

/// Generated scenes of increasing size, on one thread and on two: the tree alone, and whole renders
/// by the command line. Fails if ten million triangles need a peak of more than 1.5 GB, or a
/// million instances more than 500 MB.
#[derive(Debug, Parser)]
pub(super) struct Arguments {
    /// At most this many triangles or instances
    #[arg(long, value_name = "COUNT", default_value_t = 10_000_000)]
    most: usize,
    /// Only the tree, without whole renders
    #[arg(long, conflicts_with = "renders_only")]
    tree_only: bool,
    /// Only whole renders
    #[arg(long)]
    renders_only: bool,
    #[command(flatten)]
    keeping: SavedRun,
}

/// What is counted, the numbers of it, and the limit in megabytes for the largest number.
const SERIES: [(Kind, &[usize], f64); 2] = [
    (Kind::Triangles, &[1_000, 10_000, 100_000, 1_000_000, 10_000_000], 1500.0),
    (Kind::Instances, &[1_000, 10_000, 100_000, 1_000_000], 500.0),
];

/// One row is measured for each of these thread counts.
const THREADS: [u32; 2] = [1, 2];

/// Runs the benchmark.
pub(super) fn run(arguments: &Arguments) -> Result<(), String> {
    let trees = if arguments.renders_only { Vec::new() } else { trees(arguments)? };
    let mut broken = Vec::new();
    let renders = if arguments.tree_only { Vec::new() } else { renders(arguments, &mut broken)? };
    let figures = json!({ "trees": trees, "renders": renders });
    keep::finish("scale", &figures, &arguments.keeping)?;
    if broken.is_empty() { Ok(()) } else { Err(broken.join("; ")) }
}

/// The columns of a row for the tree alone, as the program prints them.
const TREE_COLUMNS: [(&str, &str); 5] = [
    ("build s", "build_seconds"),
    ("Mrays/s", "mrays_per_second"),
    ("tree MB", "tree_megabytes"),
    ("peak MB", "peak_megabytes"),
    ("hits", "hits"),
];

/// The tree alone: a separate process for each row, so that peaks do not mix.
fn trees(arguments: &Arguments) -> Result<Vec<Value>, String> {
    let bench = ["bench", "--quiet", "--package", "etendue-bvh", "--bench", "scale"];
    super::rays::check(cargo().args(bench).arg("--no-run"))?;
    let table = arguments.keeping.shows_table();
    if table {
        head("tree alone", &TREE_COLUMNS.map(|(title, _)| title));
    }
    let mut rows = Vec::new();
    for (kind, count, _) in cases(arguments.most) {
        for threads in THREADS {
            let mut command = cargo();
            command.args(bench).args(["--", kind.name(), &count.to_string(), &threads.to_string()]);
            let printed = etendue::output(&mut command)?;
            let figures: Vec<f64> =
                printed.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            let mut row = json!({ "kind": kind.name(), "count": count, "threads": threads });
            for ((_, name), figure) in TREE_COLUMNS.iter().zip(&figures) {
                row[*name] = json!(figure);
            }
            rows.push(row);
            if table {
                print!("{:<14}{count:>10}{threads:>9}", kind.name());
                printed.split_whitespace().for_each(|figure| print!("{figure:>12}"));
                println!();
            }
        }
    }
    Ok(rows)
}

/// Whole renders by the command line; `broken` gets a sentence for every exceeded limit.
fn renders(arguments: &Arguments, broken: &mut Vec<String>) -> Result<Vec<Value>, String> {
    if !etendue::build() {
        return Err("etendue does not compile".to_owned());
    }
    let table = arguments.keeping.shows_table();
    if table {
        println!();
        head("whole render", &["wall s", "ksamples/s", "peak MB", "limit MB"]);
    }
    let folder = etendue::folder("bench/scale")?;
    let mut rows = Vec::new();
    for (kind, count, limit) in cases(arguments.most) {
        let scene = generated::write(&folder, kind, count).map_err(|error| error.to_string())?;
        for threads in THREADS {
            let job = Job { scene: &scene, size: [320, 180], samples: 16, threads, filter: None };
            let figures = process::start(&job, "scale")?
                .finish()
                .map_err(|problem| format!("{count} {}: {problem}", kind.name()))?;
            let Figures { wall_seconds, samples_per_second, peak_megabytes, .. } = figures;
            rows.push(json!({
                "kind": kind.name(), "count": count, "threads": threads,
                "wall_seconds": wall_seconds, "samples_per_second": samples_per_second,
                "peak_megabytes": peak_megabytes, "limit_megabytes": limit,
            }));
            if table {
                let rate = samples_per_second * 1e-3;
                let limit = limit.map_or(String::new(), |limit| format!("{limit:.0}"));
                println!(
                    "{:<14}{count:>10}{threads:>9}{wall_seconds:>12.2}{rate:>12.0}{peak_megabytes:>12.1}{limit:>12}",
                    kind.name()
                );
            }
            broken.extend(exceeded(peak_megabytes, limit, kind, count));
        }
    }
    Ok(rows)
}

/// Every requested count, with its limit in megabytes if it has one.
fn cases(most: usize) -> impl Iterator<Item = (Kind, usize, Option<f64>)> {
    SERIES.into_iter().flat_map(move |(kind, counts, limit)| {
        let wanted = counts.iter().filter(move |&&count| count <= most);
        wanted.map(move |&count| (kind, count, (counts.last() == Some(&count)).then_some(limit)))
    })
}

/// The message for a peak above its limit. An unknown peak counts as above.
fn exceeded(peak: f64, limit: Option<f64>, kind: Kind, count: usize) -> Option<String> {
    let limit = limit?;
    let is_kept = peak <= limit;
    let kind = kind.name();
    (!is_kept).then(|| format!("{count} {kind} take {peak:.0} MB, not {limit:.0} at most"))
}

fn head(name: &str, columns: &[&str]) {
    print!("{name:<14}{:>10}{:>9}", "count", "threads");
    columns.iter().for_each(|column| print!("{column:>12}"));
    println!();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_numbers_have_limits() {
        let limited: Vec<_> =
            cases(usize::MAX).filter_map(|case| Some((case.1, case.2?))).collect();
        assert_eq!(limited, [(10_000_000, 1500.0), (1_000_000, 500.0)]);
        assert_eq!(cases(10_000).count(), 4);
    }

    #[test]
    fn a_limit_is_kept_up_to_itself_and_not_by_what_is_unknown() {
        let says = |peak, limit| exceeded(peak, limit, Kind::Instances, 7);
        assert_eq!(says(500.0, Some(500.0)), None);
        assert_eq!(says(1e9, None), None);
        assert!(says(500.1, Some(500.0)).is_some_and(|text| text.contains("7 instances")));
        assert!(says(f64::NAN, Some(500.0)).is_some());
    }
}

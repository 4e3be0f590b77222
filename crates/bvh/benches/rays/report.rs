//! Reports the measurements, for people and for programs.

use crate::clock::Took;
use crate::workload::{Kind, Workload};

/// The measurement of one round of one kind of ray.
pub(crate) struct Trace {
    pub(crate) kind: Kind,
    pub(crate) hits: usize,
    pub(crate) seconds: f64,
}

/// The measurements of one tracer, the best of all rounds.
#[derive(Default)]
pub(crate) struct Measured {
    pub(crate) name: String,
    pub(crate) bytes: usize,
    /// The build: processor time with one and two threads, then wall time with one and two.
    build_seconds: [Option<f64>; 4],
    hits: [usize; Kind::ALL.len()],
    seconds: [Option<f64>; Kind::ALL.len()],
}

fn least(best: &mut Option<f64>, seconds: f64) {
    *best = Some(best.map_or(seconds, |best| best.min(seconds)));
}

impl Measured {
    pub(crate) fn took_to_build(&mut self, threads: usize, took: Took) {
        least(&mut self.build_seconds[threads - 1], took.processors);
        least(&mut self.build_seconds[threads + 1], took.wall);
    }

    pub(crate) fn traced(&mut self, trace: Trace) {
        self.hits[trace.kind as usize] = trace.hits;
        least(&mut self.seconds[trace.kind as usize], trace.seconds);
    }

    /// Millions of rays per second.
    fn rate(&self, kind: Kind, workload: &Workload) -> f64 {
        let seconds = self.seconds[kind as usize].unwrap_or(f64::INFINITY);
        workload.rays(kind).len() as f64 * 1e-6 / seconds
    }

    fn build(&self) -> [f64; 4] {
        self.build_seconds.map(|seconds| seconds.unwrap_or(f64::NAN))
    }
}

/// Prints a table of rates, with ours over theirs in parentheses. Build times are processor seconds,
/// with wall seconds in parentheses.
pub(crate) fn print(triangles: usize, workload: &Workload, kinds: &[Kind], all: &[Measured]) {
    println!("{triangles} triangles; Mrays/s on one thread (and ours over theirs)");
    print!("{:20}{:>18}{:>18}{:>8}", "", "build by 1 (wall)", "by 2 (wall)", "MB");
    kinds.iter().for_each(|kind| print!("{:>17}", kind.name()));
    println!();
    let ours = &all[0];
    for measured in all {
        let [one, two, one_wall, two_wall] = measured.build();
        print!("{:20}{one:>9.3} ({one_wall:.3}) {two:>9.3} ({two_wall:.3}) ", measured.name);
        print!("{:>8.1}", measured.bytes as f64 * 1e-6);
        for &kind in kinds {
            let (own, rate) = (ours.rate(kind, workload), measured.rate(kind, workload));
            print!("{:>10.2} ({:4.2})", rate, own / rate);
        }
        println!();
    }
    for &kind in kinds {
        let hits: Vec<usize> = all.iter().map(|measured| measured.hits[kind as usize]).collect();
        let count = workload.rays(kind).len();
        println!("{:>9}: {count} rays, {hits:?} hits{}", kind.name(), verdict(&hits, count));
    }
}

/// Rays along edges, and ends on surfaces, round differently; larger differences indicate an error.
fn agree(hits: &[usize], rays: usize) -> bool {
    let (least, most) = (hits.iter().min(), hits.iter().max());
    least.zip(most).is_none_or(|(least, most)| most - least <= rays / 100_000)
}

fn verdict(hits: &[usize], rays: usize) -> &'static str {
    if agree(hits, rays) { "" } else { ": THEY DO NOT AGREE" }
}

/// The measurements as JSON.
pub(crate) fn json(
    triangles: usize,
    workload: &Workload,
    kinds: &[Kind],
    all: &[Measured],
) -> String {
    let row = |measured: &Measured| {
        let seconds = |seconds: Option<f64>| seconds.map_or("null".into(), |s| format!("{s:.4}"));
        let [one, two, one_wall, two_wall] = measured.build_seconds.map(seconds);
        let each = |value: &dyn Fn(Kind) -> String| {
            let values: Vec<String> =
                kinds.iter().map(|&kind| format!("\"{}\": {}", kind.name(), value(kind))).collect();
            values.join(", ")
        };
        let ratio = |kind| all[0].rate(kind, workload) / measured.rate(kind, workload);
        format!(
            "    {{\"name\": \"{}\", \"build_processor_seconds\": \
             [{one}, {two}],\n     \"build_wall_seconds\": [{one_wall}, {two_wall}], \"bytes\": {},\n     \
             \"mrays_per_second\": {{{}}},\n     \"ours_over_this\": {{{}}},\n     \
             \"hits\": {{{}}}}}",
            measured.name,
            measured.bytes,
            each(&|kind| format!("{:.3}", measured.rate(kind, workload))),
            each(&|kind| format!("{:.3}", ratio(kind))),
            each(&|kind| measured.hits[kind as usize].to_string()),
        )
    };
    let rows: Vec<String> = all.iter().map(row).collect();
    let rays: Vec<String> = kinds
        .iter()
        .map(|&kind| format!("\"{}\": {}", kind.name(), workload.rays(kind).len()))
        .collect();
    format!(
        "{{\"triangles\": {triangles}, \"rays\": {{{}}},\n  \"tracers\": [\n{}\n  ]}}",
        rays.join(", "),
        rows.join(",\n")
    )
}

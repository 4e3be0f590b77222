//! The kinds of samplers, and the sets that they divide samples into.

/// How the samples of one pixel are spread.
///
/// Most kinds plan for a number n of samples. Beyond it they start a fresh, independent set for every n
/// samples: the estimate stays unbiased, and its error falls as that of independent samples. The
/// others (independent, Halton, Sobol') are sequences without end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SamplerKind {
    /// No pattern: every number is a hash of where it belongs.
    Independent,
    /// A grid of k × k strata per pair of dimensions, in shuffled order, with a random point in each.
    Stratified,
    /// Correlated multi-jittering (Kensler, 2013): a grid of strata whose projections are stratified
    /// as finely as there are samples.
    Multijitter,
    /// Orthogonal array sampling of strength two (Jarosz et al., 2019; Bose's construction): every
    /// pair out of p + 1 dimensions is stratified p × p, and every dimension into p² parts.
    Orthogonal,
    /// The first blocks of the (0, 2)-sequence in base 2, shuffled and digit-scrambled per pair of
    /// dimensions (Kollig and Keller, *Efficient Multidimensional Sampling*, 2002).
    LowDiscrepancy,
    /// Halton's sequence with Owen-scrambled digits.
    Halton,
    /// Hammersley's set per pair of dimensions: index / n, jittered, and the scrambled radical
    /// inverse of the index.
    Hammersley,
    /// Sobol's first two dimensions per pair, shuffled and Owen-scrambled by hashes (Burley, 2020).
    Sobol,
}

impl SamplerKind {
    /// All kinds.
    pub const ALL: [Self; 8] = [
        Self::Independent,
        Self::Stratified,
        Self::Multijitter,
        Self::Orthogonal,
        Self::LowDiscrepancy,
        Self::Halton,
        Self::Hammersley,
        Self::Sobol,
    ];
}

/// The finite sets that a planned kind divides its samples into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SampleSets {
    /// Samples per set.
    pub(super) count: u32,
    /// Columns of the strata: for orthogonal arrays the prime.
    pub(super) columns: u32,
    /// Rows of the strata.
    pub(super) rows: u32,
}

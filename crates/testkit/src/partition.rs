//! The cells of a χ² test: a grid, cut finer where a pilot run finds the samples crowded.

use crate::quadrature::Rectangle;
use glam::DVec2;

/// A cell is cut while it holds more than this many times its even share of the pilot samples.
const CROWDING: usize = 3;
/// A coarser grid is refined as if it had this many cells.
const MIN_CELLS: usize = 64;
/// Cells are not cut below this many pilot samples.
const MIN_PILOTS: usize = 40;
/// Cuts allowed to a cell of the grid: its area shrinks by 2⁴⁰ at most.
const MAX_CUTS: u32 = 40;

/// The unit square cut into rectangles. The cuts follow from pilot samples alone, so that a test on
/// other samples stays exact.
pub(crate) struct Partition {
    resolution: (usize, usize),
    /// One tree per cell of the grid first, the nodes below them after.
    nodes: Vec<Node>,
    cells: Vec<PartitionCell>,
}

/// One rectangle of a partition.
pub(crate) struct PartitionCell {
    /// Where it is.
    pub(crate) rectangle: Rectangle,
    /// The pilot samples inside.
    pub(crate) pilots: Vec<DVec2>,
}

enum Node {
    /// An index into the cells.
    Leaf(usize),
    /// Points below `position` along `axis` go to node `first`, the others to the next.
    Cut { axis: usize, position: f64, first: usize },
}

impl Partition {
    /// The grid of `resolution` (columns, rows), refined by `pilots` inside [0, 1]².
    pub(crate) fn new(resolution: (usize, usize), pilots: &[DVec2]) -> Self {
        let resolution = (resolution.0.max(1), resolution.1.max(1));
        let count = resolution.0 * resolution.1;
        let mut buckets = vec![Vec::new(); count];
        for &pilot in pilots {
            buckets[grid_index(resolution, pilot)].push(pilot);
        }
        let limit = (CROWDING * pilots.len() / count.max(MIN_CELLS)).max(MIN_PILOTS);
        let mut partition =
            Self { resolution, nodes: (0..count).map(Node::Leaf).collect(), cells: Vec::new() };
        for (index, pilots) in buckets.into_iter().enumerate() {
            let place = (index % resolution.0, index / resolution.0);
            let rectangle = Rectangle::UNIT.cell(place, resolution);
            partition.cut(index, PartitionCell { rectangle, pilots }, limit, MAX_CUTS);
        }
        partition
    }

    /// All cells.
    pub(crate) fn cells(&self) -> &[PartitionCell] {
        &self.cells
    }

    /// The index of the cell that holds `point` of [0, 1]².
    pub(crate) fn find(&self, point: DVec2) -> usize {
        let mut index = grid_index(self.resolution, point);
        loop {
            match self.nodes[index] {
                Node::Leaf(cell) => return cell,
                Node::Cut { axis, position, first } => {
                    index = first + usize::from(point[axis] >= position);
                }
            }
        }
    }

    fn cut(&mut self, node: usize, cell: PartitionCell, limit: usize, cuts_left: u32) {
        if cell.pilots.len() <= limit || cuts_left == 0 {
            self.nodes[node] = Node::Leaf(self.cells.len());
            self.cells.push(cell);
            return;
        }
        let halves = [cell.rectangle.halves(0), cell.rectangle.halves(1)];
        let axis = crowded_axis(&halves, &cell.pilots);
        let [low, high] = halves[axis];
        let first = self.nodes.len();
        let position = high.min[axis];
        self.nodes[node] = Node::Cut { axis, position, first };
        self.nodes.extend([Node::Leaf(0), Node::Leaf(0)]);
        let (below, above) = cell.pilots.into_iter().partition(|pilot| pilot[axis] < position);
        let low = PartitionCell { rectangle: low, pilots: below };
        let high = PartitionCell { rectangle: high, pilots: above };
        self.cut(first, low, limit, cuts_left - 1);
        self.cut(first + 1, high, limit, cuts_left - 1);
    }
}

/// The axis (0 or 1) whose two halves share the points less evenly.
pub(crate) fn crowded_axis(halves: &[[Rectangle; 2]; 2], points: &[DVec2]) -> usize {
    let imbalance = |axis: usize| {
        let position = halves[axis][1].min[axis];
        let low = points.iter().filter(|point| point[axis] < position).count();
        low.abs_diff(points.len() - low)
    };
    usize::from(imbalance(1) > imbalance(0))
}

fn grid_index((columns, rows): (usize, usize), point: DVec2) -> usize {
    let column = ((point.x * columns as f64) as usize).min(columns - 1);
    let row = ((point.y * rows as f64) as usize).min(rows - 1);
    row * columns + column
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TestRng;

    #[test]
    fn points_are_found_in_the_cell_that_contains_them() {
        let mut random = TestRng::new(7);
        let mut point = move || DVec2::new(random.next_f64(), random.next_f64());
        // Crowded near (0.3, 0.3).
        let pilots: Vec<DVec2> = (0..5000).map(|_| 0.3 + 0.01 * point() * point()).collect();
        let partition = Partition::new((4, 3), &pilots);
        assert!(partition.cells().len() > 30);
        for index in 0..4000 {
            let place = if index % 2 == 0 { point() } else { 0.3 + 0.01 * point() };
            let cell = &partition.cells()[partition.find(place)];
            assert!(cell.rectangle.contains(place), "{place} {:?}", cell.rectangle);
        }
        let area: f64 = partition
            .cells()
            .iter()
            .map(|cell| (cell.rectangle.max - cell.rectangle.min).element_product())
            .sum();
        assert!((area - 1.0).abs() < 1e-12);
        let held: usize = partition.cells().iter().map(|cell| cell.pilots.len()).sum();
        assert_eq!(held, pilots.len());
    }

    #[test]
    fn identical_pilots_do_not_cut_for_ever() {
        let partition = Partition::new((1, 1), &[DVec2::splat(0.7); 1000]);
        assert_eq!(partition.cells().len(), MAX_CUTS as usize + 1);
        assert_eq!(partition.find(DVec2::ONE), partition.find(DVec2::splat(0.999)));
    }
}

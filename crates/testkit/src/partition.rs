//! The cells of a χ² test: a grid that is refined where a pilot run finds many samples.

use crate::rectangle::{Rectangle, crowded_axis};
use glam::DVec2;

/// A cell is split while it holds more than this many times its even share of the pilot samples.
const CROWDING: usize = 3;
/// A coarser grid is refined as if it had this many cells.
const MIN_CELLS: usize = 64;
/// Cells with this many pilot samples or fewer are not split.
const MIN_PILOTS: usize = 40;
/// The maximum number of splits per cell of the grid: its area shrinks by at most 2⁴⁰.
const MAX_SPLITS: u32 = 40;

/// A partition of the unit square into rectangles. It depends only on pilot samples, so the test of
/// other samples stays exact.
pub(crate) struct Partition {
    resolution: (usize, usize),
    /// First the root of one tree per cell of the grid, then the nodes below them.
    nodes: Vec<Node>,
    cells: Vec<PartitionCell>,
}

/// One rectangle of a partition.
pub(crate) struct PartitionCell {
    /// Its area.
    pub(crate) rectangle: Rectangle,
    /// The pilot samples inside.
    pub(crate) pilots: Vec<DVec2>,
}

/// A node of the trees.
enum Node {
    /// An index into the cells.
    Leaf(usize),
    /// Points below `position` along `axis` go to node `first`, the others to `first + 1`.
    Split { axis: usize, position: f64, first: usize },
}

impl Partition {
    /// The grid of `resolution` (columns, rows), refined by `pilots` in [0, 1]².
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
            partition.split(index, PartitionCell { rectangle, pilots }, limit, MAX_SPLITS);
        }
        partition
    }

    pub(crate) fn cells(&self) -> &[PartitionCell] {
        &self.cells
    }

    /// The index of the cell that contains `point` of [0, 1]².
    pub(crate) fn find(&self, point: DVec2) -> usize {
        let mut index = grid_index(self.resolution, point);
        loop {
            match self.nodes[index] {
                Node::Leaf(cell) => return cell,
                Node::Split { axis, position, first } => {
                    index = first + usize::from(point[axis] >= position);
                }
            }
        }
    }

    fn split(&mut self, node: usize, cell: PartitionCell, limit: usize, splits_left: u32) {
        if cell.pilots.len() <= limit || splits_left == 0 {
            self.nodes[node] = Node::Leaf(self.cells.len());
            self.cells.push(cell);
            return;
        }
        let halves = [cell.rectangle.halves(0), cell.rectangle.halves(1)];
        let axis = crowded_axis(&halves, &cell.pilots);
        let [low, high] = halves[axis];
        let first = self.nodes.len();
        let position = high.min[axis];
        self.nodes[node] = Node::Split { axis, position, first };
        self.nodes.extend([Node::Leaf(0), Node::Leaf(0)]);
        let (below, above) = cell.pilots.into_iter().partition(|pilot| pilot[axis] < position);
        let low = PartitionCell { rectangle: low, pilots: below };
        let high = PartitionCell { rectangle: high, pilots: above };
        self.split(first, low, limit, splits_left - 1);
        self.split(first + 1, high, limit, splits_left - 1);
    }
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
    fn identical_pilots_do_not_split_forever() {
        let partition = Partition::new((1, 1), &[DVec2::splat(0.7); 1000]);
        assert_eq!(partition.cells().len(), MAX_SPLITS as usize + 1);
        assert_eq!(partition.find(DVec2::ONE), partition.find(DVec2::splat(0.999)));
    }
}

//! A hierarchy of boxes that rays walk without a stack: nodes in depth-first order, each with the number of the node
//! that comes next where its box is missed (Smits 1998, *Efficiency Issues for Ray Tracing*). Deviation: nodes are
//! divided at the median along the widest axis, which costs little enough to do it anew in every frame.

use glam::Vec3;

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub low: Vec3,
    pub high: Vec3,
}

impl Bounds {
    const NOTHING: Self = Self {
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
    };

    fn joined(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}

/// A node: a box around some items, or around one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub bounds: Bounds,
    /// The node that comes next where this one is missed.
    pub skip: u32,
    /// The item of a leaf.
    pub item: Option<u32>,
}

/// The hierarchy around items with these boxes: 2n − 1 nodes, none without items.
pub(super) fn hierarchy(boxes: &[Bounds]) -> Vec<Node> {
    let mut items: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = Vec::with_capacity(2 * boxes.len());
    if !items.is_empty() {
        add(&mut nodes, boxes, &mut items);
    }
    nodes
}

fn add(nodes: &mut Vec<Node>, boxes: &[Bounds], items: &mut [u32]) {
    let box_of = |item: &u32| boxes[*item as usize];
    let bounds = items
        .iter()
        .map(box_of)
        .fold(Bounds::NOTHING, Bounds::joined);
    let number = nodes.len();
    nodes.push(Node {
        bounds,
        skip: number as u32 + 1,
        item: (items.len() == 1).then(|| items[0]),
    });
    if items.len() == 1 {
        return;
    }
    // Twice the middle of each box.
    let middle = |item: &u32| box_of(item).low + box_of(item).high;
    let middles = items.iter().map(middle).fold(Bounds::NOTHING, |all, at| {
        all.joined(Bounds { low: at, high: at })
    });
    let widths = middles.high - middles.low;
    let axis = widths.max_position();
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |a, b| {
        let order = middle(a)[axis].total_cmp(&middle(b)[axis]);
        order.then(a.cmp(b))
    });
    let (first, second) = items.split_at_mut(half);
    add(nodes, boxes, first);
    add(nodes, boxes, second);
    nodes[number].skip = nodes.len() as u32;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes(count: u32) -> Vec<Bounds> {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 65_536.0
        };
        (0..count)
            .map(|_| {
                let low = Vec3::new(random(), random(), random());
                Bounds {
                    low,
                    high: low + 3.0,
                }
            })
            .collect()
    }

    /// Items whose boxes contain the point, by the walk of the shaders.
    fn found(nodes: &[Node], point: Vec3) -> Vec<u32> {
        let mut items = Vec::new();
        let mut number = 0;
        while let Some(node) = nodes.get(number) {
            let Bounds { low, high } = node.bounds;
            if point.cmplt(low).any() || point.cmpgt(high).any() {
                number = node.skip as usize;
                continue;
            }
            items.extend(node.item);
            number += 1;
        }
        items.sort_unstable();
        items
    }

    #[test]
    fn a_walk_finds_every_box_around_a_point() {
        for count in [0, 1, 2, 3, 7, 100] {
            let boxes = boxes(count);
            let nodes = hierarchy(&boxes);
            assert_eq!(nodes.len(), (2 * boxes.len()).saturating_sub(1));
            for wanted in &boxes {
                let point = wanted.low + 1.5;
                let holds =
                    |other: &Bounds| point.cmpge(other.low).all() && point.cmple(other.high).all();
                let all = (0u32..).zip(&boxes).filter(|(_, other)| holds(other));
                let all: Vec<u32> = all.map(|(item, _)| item).collect();
                assert!(!all.is_empty());
                assert_eq!(found(&nodes, point), all);
            }
        }
    }

    #[test]
    fn a_miss_of_everything_looks_at_one_node() {
        let nodes = hierarchy(&boxes(64));
        assert_eq!(nodes[0].skip as usize, nodes.len());
        assert!(found(&nodes, Vec3::splat(-1.0)).is_empty());
    }

    #[test]
    fn the_same_boxes_give_the_same_nodes() {
        // Equal middles, too.
        let mut boxes = boxes(40);
        boxes.extend_from_within(..);
        assert_eq!(hierarchy(&boxes), hierarchy(&boxes.clone()));
    }
}

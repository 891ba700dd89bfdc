//! A hierarchy of boxes that rays walk without a stack: nodes in depth-first order, each with the number of the node
//! that comes next where its box is missed (Smits 1998, *Efficiency Issues for Ray Tracing*). Deviations: nodes are
//! divided at the median along the widest axis, which costs little enough to do it anew in every frame; and there is an
//! order for each octant of directions, in which a ray meets the nearer part of a node first, so that it need not look at
//! what lies behind its hit.

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
    pub part: Part,
}

/// What a node is around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    Item(u32),
    /// Two nodes: the first one follows, and lies lower along this axis than the second.
    Divided(usize),
}

impl Node {
    /// The item of a leaf.
    pub fn item(&self) -> Option<u32> {
        match self.part {
            Part::Item(item) => Some(item),
            Part::Divided(_) => None,
        }
    }
}

/// Octants of directions. In octant `o` the bit `axis` is set where directions point towards lower coordinates.
pub(super) const OCTANTS: usize = 8;

/// The hierarchy around items with these boxes: 2n − 1 nodes, none without items. The order is that of octant 0.
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
    // Twice the middle of each box.
    let middle = |item: &u32| box_of(item).low + box_of(item).high;
    let middles = items.iter().map(middle).fold(Bounds::NOTHING, |all, at| {
        all.joined(Bounds { low: at, high: at })
    });
    let axis = (middles.high - middles.low).max_position();
    let part = match items {
        [item] => Part::Item(*item),
        _ => Part::Divided(axis),
    };
    nodes.push(Node {
        bounds,
        skip: number as u32 + 1,
        part,
    });
    if items.len() == 1 {
        return;
    }
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

/// The same hierarchy in the order of another octant. Nodes are numbered from 0 again.
pub(super) fn in_order(nodes: &[Node], octant: usize) -> Vec<Node> {
    let mut ordered = Vec::with_capacity(nodes.len());
    if !nodes.is_empty() {
        add_in_order(&mut ordered, nodes, 0, octant);
    }
    ordered
}

fn add_in_order(ordered: &mut Vec<Node>, nodes: &[Node], number: usize, octant: usize) {
    let at = ordered.len();
    ordered.push(nodes[number]);
    if let Part::Divided(axis) = nodes[number].part {
        let first = number + 1;
        let mut parts = [first, nodes[first].skip as usize];
        if octant >> axis & 1 == 1 {
            parts.reverse();
        }
        for part in parts {
            add_in_order(ordered, nodes, part, octant);
        }
    }
    ordered[at].skip = ordered.len() as u32;
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
            items.extend(node.item());
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
                for octant in 0..OCTANTS {
                    assert_eq!(found(&in_order(&nodes, octant), point), all, "{octant}");
                }
            }
        }
    }

    #[test]
    fn rays_meet_the_nearer_part_first() {
        let nodes = hierarchy(&boxes(50));
        assert_eq!(in_order(&nodes, 0), nodes);
        for octant in 0..OCTANTS {
            let ordered = in_order(&nodes, octant);
            for (number, node) in ordered.iter().enumerate() {
                let Part::Divided(axis) = node.part else {
                    continue;
                };
                let first = ordered[number + 1];
                let second = ordered[first.skip as usize];
                let lower = |a: &Node, b: &Node| a.bounds.low[axis] <= b.bounds.low[axis];
                match octant >> axis & 1 {
                    0 => assert!(lower(&first, &second)),
                    _ => assert!(lower(&second, &first)),
                }
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

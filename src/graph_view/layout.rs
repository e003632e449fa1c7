//! A small layered layout, left to right, after Sugiyama, Tagawa and Toda, Methods for Visual
//! Understanding of Hierarchical System Structures (1981): cycles are broken, nodes are put into layers, the
//! order within a layer follows the neighbours, long edges pass through the layers between.

/// A box to be placed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    pub w: f64,
    pub h: f64,
}

/// An edge between two boxes. `y` are the heights, from the boxes' tops, at which it leaves and arrives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    pub from: usize,
    pub to: usize,
    pub from_y: f64,
    pub to_y: f64,
    /// Room the label needs.
    pub label_w: f64,
}

/// Where everything is.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Placed {
    /// Top left corner of each box.
    pub boxes: Vec<(f64, f64)>,
    /// Points each edge passes, from source to target.
    pub routes: Vec<Vec<(f64, f64)>>,
    /// Extent of the whole.
    pub w: f64,
    pub h: f64,
}

/// Space between boxes of a layer.
const ROW: f64 = 18.0;
/// Least space between layers.
const COLUMN: f64 = 46.0;
/// Height reserved for an edge that passes through a layer.
const LANE: f64 = 14.0;

/// Heights at which labelled edges leave and arrive, one of its own for each on its side of a box, so
/// that their labels stand below each other; and the height each box needs for them.
pub fn slots(heights: &[f64], edges: &[(usize, usize, bool)]) -> (Vec<f64>, Vec<(f64, f64)>) {
    let pairs: Vec<(usize, usize)> = edges.iter().map(|(a, b, _)| (*a, *b)).collect();
    let reversed = back_edges(heights.len(), &pairs);
    // Ends by box and side: left (0) takes what comes forth, right (1) what goes forth.
    let mut taken = vec![[0usize; 2]; heights.len()];
    let mut ends = vec![(None, None); edges.len()];
    for (i, (a, b, labelled)) in edges.iter().enumerate().filter(|(_, (a, b, _))| a != b) {
        if *labelled {
            let (out, into) = if reversed[i] { (0, 1) } else { (1, 0) };
            ends[i] = (Some(taken[*a][out]), Some(taken[*b][into]));
            taken[*a][out] += 1;
            taken[*b][into] += 1;
        }
    }
    let needed: Vec<f64> =
        heights.iter().zip(&taken).map(|(h, t)| h.max(SLOT * t[0].max(t[1]) as f64 + 10.0)).collect();
    let at = |node: usize, side: usize, slot: Option<usize>| match slot {
        None => needed[node] / 2.0,
        Some(k) => needed[node] / 2.0 + SLOT * (k as f64 - (taken[node][side] as f64 - 1.0) / 2.0),
    };
    let places = (0..edges.len())
        .map(|i| {
            let (out, into) = if reversed[i] { (0, 1) } else { (1, 0) };
            (at(edges[i].0, out, ends[i].0), at(edges[i].1, into, ends[i].1))
        })
        .collect();
    (needed, places)
}

/// Height of a labelled edge's end.
const SLOT: f64 = 15.0;

/// Places boxes and routes edges.
pub fn place(sizes: &[Size], edges: &[Edge]) -> Placed {
    if sizes.is_empty() {
        return Placed::default();
    }
    let reversed = back_edges(sizes.len(), &edges.iter().map(|e| (e.from, e.to)).collect::<Vec<_>>());
    let layer = layers(sizes.len(), edges, &reversed);
    let mut net = Net::new(sizes, edges, &reversed, &layer);
    net.order();
    net.coordinates();
    net.placed(sizes, edges, &reversed)
}

/// Edges that close a cycle in a depth-first walk from the first box on.
fn back_edges(n: usize, edges: &[(usize, usize)]) -> Vec<bool> {
    let mut out: Vec<Vec<usize>> = vec![Vec::new(); n];
    for (i, (from, _)) in edges.iter().enumerate() {
        out[*from].push(i);
    }
    // 0 new, 1 on the path, 2 done
    let (mut state, mut reversed) = (vec![0u8; n], vec![false; edges.len()]);
    for root in 0..n {
        if state[root] != 0 {
            continue;
        }
        state[root] = 1;
        let mut path = vec![(root, 0)];
        while let Some((v, next)) = path.pop() {
            match out[v].get(next) {
                Some(&e) => {
                    path.push((v, next + 1));
                    let w = edges[e].1;
                    match state[w] {
                        0 => {
                            state[w] = 1;
                            path.push((w, 0));
                        }
                        1 => reversed[e] = true,
                        _ => {}
                    }
                }
                None => state[v] = 2,
            }
        }
    }
    reversed
}

/// Longest path from the sources; then sources move right up to their first successor.
fn layers(n: usize, edges: &[Edge], reversed: &[bool]) -> Vec<usize> {
    let ends =
        |i: usize| if reversed[i] { (edges[i].to, edges[i].from) } else { (edges[i].from, edges[i].to) };
    let mut layer = vec![0; n];
    // At most n rounds: without cycles the longest path has n - 1 edges.
    for _ in 0..n {
        let mut changed = false;
        for i in 0..edges.len() {
            let (a, b) = ends(i);
            if a != b && layer[b] <= layer[a] {
                layer[b] = layer[a] + 1;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    for v in 0..n {
        let has_input = (0..edges.len()).any(|i| ends(i).1 == v && ends(i).0 != v);
        let first =
            (0..edges.len()).filter(|i| ends(*i).0 == v && ends(*i).1 != v).map(|i| layer[ends(i).1]).min();
        if let (false, Some(l)) = (has_input, first) {
            layer[v] = l - 1;
        }
    }
    layer
}

/// Boxes and the points where long edges pass a layer.
struct Net {
    /// Layer of each node; boxes come first.
    layer: Vec<usize>,
    height: Vec<f64>,
    width: Vec<f64>,
    /// Neighbours to the left and right with the height at which the line meets this node and that one.
    links: Vec<(usize, usize, f64, f64)>,
    rows: Vec<Vec<usize>>,
    y: Vec<f64>,
    /// Nodes each edge passes, left to right.
    chains: Vec<Vec<usize>>,
    /// Widest label between a layer and the next.
    gaps: Vec<f64>,
}

impl Net {
    fn new(sizes: &[Size], edges: &[Edge], reversed: &[bool], layer: &[usize]) -> Net {
        let count = layer.iter().max().map_or(1, |m| m + 1);
        let mut net = Net {
            layer: layer.to_vec(),
            height: sizes.iter().map(|s| s.h).collect(),
            width: sizes.iter().map(|s| s.w).collect(),
            links: Vec::new(),
            rows: vec![Vec::new(); count],
            y: Vec::new(),
            chains: Vec::new(),
            gaps: vec![COLUMN; count],
        };
        for (i, e) in edges.iter().enumerate() {
            let (a, b, ay, by) =
                if reversed[i] { (e.to, e.from, e.to_y, e.from_y) } else { (e.from, e.to, e.from_y, e.to_y) };
            let mut chain = vec![a];
            if a != b {
                let (mut last, mut last_y) = (a, ay);
                for l in layer[a] + 1..layer[b] {
                    let lane = net.layer.len();
                    net.layer.push(l);
                    net.height.push(LANE);
                    net.width.push(0.0);
                    net.links.push((last, lane, last_y, LANE / 2.0));
                    chain.push(lane);
                    (last, last_y) = (lane, LANE / 2.0);
                }
                net.links.push((last, b, last_y, by));
                chain.push(b);
                // The label stands in the gap before the arrow's head.
                let gap = if reversed[i] { layer[a] } else { layer[b] - 1 };
                net.gaps[gap] = net.gaps[gap].max(COLUMN + e.label_w);
            }
            net.chains.push(chain);
        }
        for v in 0..net.layer.len() {
            net.rows[net.layer[v]].push(v);
        }
        net
    }

    /// Sorts each layer by the mean place of its neighbours, to and fro.
    fn order(&mut self) {
        let n = self.layer.len();
        let mut place = vec![0.0; n];
        let (mut left, mut right) = (vec![Vec::new(); n], vec![Vec::new(); n]);
        for (a, b, ay, by) in &self.links {
            right[*a].push((*b, *by));
            left[*b].push((*a, *ay));
        }
        self.stack(&mut place);
        for sweep in 0..8 {
            let forth = sweep % 2 == 0;
            let side = if forth { &left } else { &right };
            let count = self.rows.len();
            for k in 0..count {
                let row = if forth { k } else { count - 1 - k };
                let mean = |v: usize| {
                    let near = &side[v];
                    if near.is_empty() {
                        return place[v] + self.height[v] / 2.0;
                    }
                    near.iter().map(|(u, y)| place[*u] + y).sum::<f64>() / near.len() as f64
                };
                let mut keyed: Vec<(f64, usize)> = self.rows[row].iter().map(|v| (mean(*v), *v)).collect();
                keyed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                self.rows[row] = keyed.into_iter().map(|(_, v)| v).collect();
                let mut y = 0.0;
                for v in &self.rows[row] {
                    place[*v] = y;
                    y += self.height[*v] + ROW;
                }
            }
        }
        self.y = place;
    }

    fn stack(&self, place: &mut [f64]) {
        for row in &self.rows {
            let mut y = 0.0;
            for v in row {
                place[*v] = y;
                y += self.height[*v] + ROW;
            }
        }
    }

    /// Moves nodes towards their neighbours without changing the order in a layer.
    fn coordinates(&mut self) {
        let n = self.layer.len();
        let mut near: Vec<Vec<(usize, f64, f64)>> = vec![Vec::new(); n];
        for (a, b, ay, by) in &self.links {
            near[*a].push((*b, *ay, *by));
            near[*b].push((*a, *by, *ay));
        }
        for _ in 0..24 {
            for row in 0..self.rows.len() {
                let wish: Vec<f64> = self.rows[row]
                    .iter()
                    .map(|v| match near[*v].len() {
                        0 => self.y[*v],
                        k => {
                            near[*v].iter().map(|(u, own, other)| self.y[*u] + other - own).sum::<f64>()
                                / k as f64
                        }
                    })
                    .collect();
                self.settle(row, &wish);
            }
        }
        let top = self.y.iter().copied().fold(f64::INFINITY, f64::min);
        self.y.iter_mut().for_each(|y| *y -= top);
    }

    /// Places a row as near to its wishes as the order and the heights allow: nodes that would overlap
    /// form a block that sits at the mean of their wishes.
    fn settle(&mut self, row: usize, wish: &[f64]) {
        // first index, sum of (wish - offset), count, height
        let mut blocks: Vec<(usize, f64, f64, f64)> = Vec::new();
        for (i, w) in wish.iter().enumerate() {
            let mut block = (i, *w, 1.0, self.height[self.rows[row][i]] + ROW);
            while let Some(last) = blocks.last().copied() {
                if last.1 / last.2 + last.3 <= block.1 / block.2 {
                    break;
                }
                blocks.pop();
                block = (last.0, last.1 + block.1 - block.2 * last.3, last.2 + block.2, last.3 + block.3);
            }
            blocks.push(block);
        }
        for (k, b) in blocks.iter().enumerate() {
            let end = blocks.get(k + 1).map_or(wish.len(), |n| n.0);
            let mut y = b.1 / b.2;
            for i in b.0..end {
                let v = self.rows[row][i];
                self.y[v] = y;
                y += self.height[v] + ROW;
            }
        }
    }

    fn placed(&self, sizes: &[Size], edges: &[Edge], reversed: &[bool]) -> Placed {
        let mut x = 0.0;
        let (mut left, mut widths) = (Vec::new(), Vec::new());
        for (row, gap) in self.rows.iter().zip(&self.gaps) {
            let w = row.iter().map(|v| self.width[*v]).fold(0.0, f64::max);
            left.push(x);
            widths.push(w);
            x += w + gap;
        }
        let w = x - self.gaps.last().copied().unwrap_or(0.0);
        let corner =
            |v: usize| (left[self.layer[v]] + (widths[self.layer[v]] - self.width[v]) / 2.0, self.y[v]);
        let mut routes = Vec::new();
        for (i, e) in edges.iter().enumerate() {
            let chain = &self.chains[i];
            let mut points = Vec::new();
            if e.from != e.to {
                let (ends_y, last) =
                    (if reversed[i] { (e.to_y, e.from_y) } else { (e.from_y, e.to_y) }, chain.len() - 1);
                let (ax, ay) = corner(chain[0]);
                points.push((ax + self.width[chain[0]], ay + ends_y.0));
                for v in &chain[1..last] {
                    // A lane is as wide as its layer, so that lines do not bend below boxes.
                    let (lx, ly) = (left[self.layer[*v]], self.y[*v] + LANE / 2.0);
                    points.push((lx, ly));
                    points.push((lx + widths[self.layer[*v]], ly));
                }
                let (bx, by) = corner(chain[last]);
                points.push((bx, by + ends_y.1));
                if reversed[i] {
                    points.reverse();
                }
            }
            routes.push(points);
        }
        let h = (0..self.layer.len()).map(|v| self.y[v] + self.height[v]).fold(0.0, f64::max);
        Placed { boxes: (0..sizes.len()).map(corner).collect(), routes, w, h }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_of_a_cyclic_graph_do_not_overlap() {
        let sizes: Vec<Size> =
            (0..9).map(|i| Size { w: 40.0 + i as f64, h: 20.0 + 3.0 * i as f64 }).collect();
        let pairs =
            [(0, 1), (1, 2), (2, 0), (0, 3), (3, 4), (0, 4), (4, 4), (5, 4), (6, 4), (7, 8), (8, 0), (2, 8)];
        let edges: Vec<Edge> = pairs
            .iter()
            .map(|(a, b)| Edge { from: *a, to: *b, from_y: 10.0, to_y: 10.0, label_w: 0.0 })
            .collect();
        let p = place(&sizes, &edges);
        for i in 0..sizes.len() {
            for j in 0..i {
                let ((ax, ay), (bx, by)) = (p.boxes[i], p.boxes[j]);
                let apart = ax + sizes[i].w <= bx
                    || bx + sizes[j].w <= ax
                    || ay + sizes[i].h <= by
                    || by + sizes[j].h <= ay;
                assert!(apart, "{i} and {j} overlap: {p:?}");
            }
        }
        assert_eq!(p, place(&sizes, &edges));
    }
}

//! Functions of repeated and scattered sub-trees.

use glam::DVec3;

use super::super::{repeat::Repeat, scatter::Scatter};
use super::{Writer, number, push, single, vector};

impl Writer<'_> {
    pub(super) fn repeat(&mut self, repeat: &Repeat) -> String {
        let (name, of) = (self.name("repeat"), self.name("tile"));
        self.function(&of, &repeat.of);
        let repeats = repeat.period.cmpgt(DVec3::ZERO);
        let period = vector(DVec3::select(repeats, repeat.period, DVec3::ONE));
        let zero_or_period = vector(repeat.period);
        let repeats_vector = format!("vec3<bool>({}, {}, {})", repeats.x, repeats.y, repeats.z);
        let corners = repeats.bitmask();
        let (min, max) = (vector(repeat.bounds.min), vector(repeat.bounds.max));
        let clearance = number(repeat.clearance);
        push(
            &mut self.module,
            format_args!(
                "
fn {name}(p: vec3f) -> f32 {{
    let tile = select(vec3f(0.0), round(p / {period}), {repeats_vector});
    let local = p - tile * {zero_or_period};
    let lean = select({zero_or_period}, -{zero_or_period}, local < vec3f(0.0));
    var nearest = {clearance};
    for (var corner = 0u; corner < 8u; corner += 1u) {{
        if (corner & {corners}u) != corner {{
            continue;
        }}
        let q = local - vec3f(vec3u(corner, corner >> 1u, corner >> 2u) & vec3u(1u)) * lean;
        let to_bounds = length(max(max({min} - q, q - {max}), vec3f(0.0)));
        if to_bounds < nearest {{
            let value = {of}(q);
            nearest = min(nearest, select(value, max(value, to_bounds), to_bounds > 0.0));
        }}
    }}
    return nearest;
}}
"
            ),
        );
        name
    }

    pub(super) fn scatter(&mut self, scatter: &Scatter) -> String {
        let (name, of) = (self.name("scatter"), self.name("copy"));
        self.function(&of, &scatter.of);
        let (centre, half) = scatter.content();
        let last = scatter.cells - 1;
        let grid = [
            vector(scatter.start.as_dvec3()),
            single(scatter.cell),
            format!("vec3i({}, {}, {})", last.x, last.y, last.z),
            single(scatter.jitter),
            vector(centre),
            number(scatter.clearance()),
            vector(half),
            single(scatter.reach),
            single(scatter.scale_low),
            single(scatter.scale_span),
            format!("{}u", scatter.threshold),
            format!("{}u", scatter.seed_bits),
        ]
        .join(", ");
        push(
            &mut self.module,
            format_args!(
                "
fn {name}(p: vec3f) -> f32 {{
    let grid = ScatterGrid({grid});
    let outside = scatter_outside(grid, p);
    var nearest = grid.clearance;
    if outside >= nearest {{
        return outside;
    }}
    for (var k = 0u; k < SCATTER_ALL; k += 1u) {{
        if k == SCATTER_NEAR && nearest <= scatter_near_clearance(grid) {{
            break;
        }}
        let copy = scatter_copy(grid, p, k, nearest);
        if copy.scale > 0.0 {{
            let value = {of}((p - copy.centre) / copy.scale) * copy.scale;
            nearest = min(nearest, max(value, copy.to_sphere));
        }}
    }}
    return select(nearest, max(nearest, outside), outside > 0.0);
}}
"
            ),
        );
        name
    }
}

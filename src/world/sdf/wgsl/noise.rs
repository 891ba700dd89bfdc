//! Functions of the noise fields.

use super::super::NoiseId;
use super::{Module, number, push, vector};
use crate::world::noise::{Basis, Fractal, NoiseBank, NoiseField, RIDGE_ATTENUATION};

impl Module {
    /// Declares the function of a noise field.
    pub(super) fn noise(&mut self, id: NoiseId, bank: &NoiseBank) {
        self.imports
            .insert("package::sdf::noise::{perlin3, open_simplex3, worley3, value3}");
        let field = bank.field(id);
        let basis = match field.basis {
            Basis::Perlin => "perlin3",
            Basis::OpenSimplex => "open_simplex3",
            Basis::Worley => "worley3",
            Basis::Value => "value3",
        };
        let table = bank.first_table(id);
        let at = format!("p * {} + {}", vector(field.frequency), vector(field.offset));
        let body = match Octaves::of(field, &format!("{basis}(q, {table}u + octave)")) {
            None => format!("    return {basis}({at}, {table}u);\n"),
            Some(octaves) => octaves.sum(field, &at),
        };
        push(
            &mut self.fields,
            format_args!("\nfn noise_{id}(p: vec3f) -> f32 {{\n{body}}}\n"),
        );
    }
}

/// How a fractal sums its octaves.
struct Octaves {
    /// Statements before the loop.
    before: &'static str,
    /// Statements that give an octave's `signal`.
    signal: String,
    /// Amplitude of the first octave.
    amplitude: f64,
    /// Ratio of the amplitudes of successive octaves.
    persistence: f64,
    /// Ratio of their frequencies.
    lacunarity: f64,
    /// Added to the sum.
    shift: &'static str,
}

impl Octaves {
    /// `sample` is the value of the octave `octave` at `q`. `None`: the basis alone.
    fn of(field: &NoiseField, sample: &str) -> Option<Self> {
        let plain = |signal, lacunarity, persistence| Self {
            before: "",
            signal,
            amplitude: persistence,
            persistence,
            lacunarity,
            shift: "",
        };
        match field.fractal {
            Fractal::None => None,
            Fractal::Fbm {
                lacunarity,
                persistence,
                ..
            } => {
                let signal = format!("let signal = {sample};");
                Some(plain(signal, lacunarity, persistence))
            }
            Fractal::Billow {
                lacunarity,
                persistence,
                ..
            } => {
                let signal = format!("let signal = abs({sample}) * 2.0 - 1.0;");
                Some(plain(signal, lacunarity, persistence))
            }
            Fractal::Ridged {
                lacunarity,
                persistence,
                ..
            } => Some(Self {
                before: "    var weight = 1.0;\n",
                signal: ridge(sample),
                amplitude: 1.0,
                // Ridges begin at 0; the field begins at −1.
                shift: " - 1.0",
                ..plain(String::new(), lacunarity, persistence)
            }),
        }
    }

    /// The body of a function that sums the octaves, the first at the point `at`.
    fn sum(&self, field: &NoiseField, at: &str) -> String {
        let Self {
            before,
            signal,
            shift,
            ..
        } = self;
        let (lacunarity, persistence) = (number(self.lacunarity), number(self.persistence));
        let (amplitude, scale) = (number(self.amplitude), number(field.scale()));
        let octaves = field.octaves();
        format!(
            "    var q = {at};
    var sum = 0.0;
    var amplitude = {amplitude};
{before}    for (var octave = 0u; octave < {octaves}u; octave += 1u) {{
        {signal}
        sum += signal * amplitude;
        amplitude *= {persistence};
        q *= {lacunarity};
    }}
    return sum * {scale}{shift};
"
        )
    }
}

/// A crest where the sample is 0, weighted by the crest of the octave before.
fn ridge(sample: &str) -> String {
    let attenuation = number(RIDGE_ATTENUATION);
    format!(
        "let ridge = 1.0 - abs({sample});
        let signal = ridge * ridge * weight;
        weight = clamp(signal / {attenuation}, 0.0, 1.0);"
    )
}

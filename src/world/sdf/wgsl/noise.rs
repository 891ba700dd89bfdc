//! Functions of the noise fields.

use super::super::NoiseId;
use super::{Module, number, push, vector};
use crate::world::noise::{Basis, Fractal, NoiseBank, RIDGE_ATTENUATION};

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
        let (frequency, offset) = (vector(field.frequency), vector(field.offset));
        let sample = format!("{basis}(q, {table}u + octave)");
        // What comes before the loop, what makes an octave's signal, and the first amplitude.
        let (before, signal, amplitude) = match field.fractal {
            Fractal::None => ("", String::new(), 1.0),
            Fractal::Fbm { persistence, .. } => {
                ("", format!("let signal = {sample};"), persistence)
            }
            Fractal::Billow { persistence, .. } => (
                "",
                format!("let signal = abs({sample}) * 2.0 - 1.0;"),
                persistence,
            ),
            Fractal::Ridged { .. } => {
                let attenuation = number(RIDGE_ATTENUATION);
                let signal = format!(
                    "let ridge = 1.0 - abs({sample});
        let signal = ridge * ridge * weight;
        weight = clamp(signal / {attenuation}, 0.0, 1.0);"
                );
                ("    var weight = 1.0;\n", signal, 1.0)
            }
        };
        let body = match field.fractal {
            Fractal::None => {
                format!("    return {basis}(p * {frequency} + {offset}, {table}u);\n")
            }
            Fractal::Fbm {
                lacunarity,
                persistence,
                ..
            }
            | Fractal::Billow {
                lacunarity,
                persistence,
                ..
            }
            | Fractal::Ridged {
                lacunarity,
                persistence,
                ..
            } => {
                let (lacunarity, persistence) = (number(lacunarity), number(persistence));
                let (amplitude, scale) = (number(amplitude), number(field.scale()));
                let octaves = field.octaves();
                // Ridges begin at 0; the field begins at −1.
                let shift = if before.is_empty() { "" } else { " - 1.0" };
                format!(
                    "    var q = p * {frequency} + {offset};
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
        };
        push(
            &mut self.fields,
            format_args!("\nfn noise_{id}(p: vec3f) -> f32 {{\n{body}}}\n"),
        );
    }
}

//! Shader composition. The only file that knows that it is done by WESL.

use std::{borrow::Cow, collections::HashMap, path::PathBuf};

use wesl::{CompileOptions, Mangler, ModulePath, ResolveError, Resolver};

use super::GpuError;

const EMBEDDED: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// Where shader modules come from: the binary, or the folder `shaders/` (for hot reload).
pub struct ShaderLibrary {
    embedded: HashMap<&'static str, &'static str>,
    folder: Option<PathBuf>,
}

/// A whole shader: plain WGSL, and the naga module that it parses to.
pub struct Composed {
    pub name: String,
    pub wgsl: String,
    pub module: naga::Module,
    pub info: naga::valid::ModuleInfo,
}

impl ShaderLibrary {
    pub fn embedded() -> Self {
        Self {
            embedded: EMBEDDED.iter().copied().collect(),
            folder: None,
        }
    }

    /// Reads modules from `folder` each time, so that edits show.
    pub fn from_folder(folder: PathBuf) -> Self {
        Self {
            folder: Some(folder),
            ..Self::embedded()
        }
    }

    /// Whether the same name may give another text tomorrow.
    pub fn changes(&self) -> bool {
        self.folder.is_some()
    }

    /// The names of all embedded modules, as `passes/shade`.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.embedded.keys().copied()
    }

    /// Resolves the imports of module `name` (`passes/shade`). `generated` adds modules that are
    /// made at run time, imported as `package::generated::NAME`.
    ///
    /// # Errors
    /// [`GpuError::Shader`] with the place, for a missing module, a syntax error, a type error.
    pub fn compose(&self, name: &str, generated: &[(&str, &str)]) -> Result<Composed, GpuError> {
        let fault = |message: String| GpuError::Shader {
            name: name.to_owned(),
            message,
        };
        let root: ModulePath = format!("package::{}", name.replace('/', "::"))
            .parse()
            .map_err(|error| fault(format!("{error:?}")))?;
        let resolver = LibraryResolver {
            library: self,
            generated,
        };
        let options = CompileOptions {
            validate: false,
            ..CompileOptions::default()
        };
        let wgsl = wesl::compile_sourcemap(&root, &resolver, &ReadableMangler, &options)
            .map_err(|error| fault(error.to_string()))?
            .to_string();
        let module = naga::front::wgsl::parse_str(&wgsl)
            .map_err(|error| fault(error.emit_to_string_with_path(&wgsl, name)))?;
        let info = naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::all(),
        )
        .validate(&module)
        .map_err(|error| fault(error.emit_to_string_with_path(&wgsl, name)))?;
        Ok(Composed {
            name: name.to_owned(),
            wgsl,
            module,
            info,
        })
    }
}

struct LibraryResolver<'a> {
    library: &'a ShaderLibrary,
    generated: &'a [(&'a str, &'a str)],
}

impl Resolver for LibraryResolver<'_> {
    fn resolve_source<'b>(&'b self, path: &ModulePath) -> Result<Cow<'b, str>, ResolveError> {
        let name = path.components.join("/");
        let missing = || ResolveError::ModuleNotFound(path.clone(), format!("no shader `{name}`"));
        if let Some(generated) = name.strip_prefix("generated/") {
            let found = self.generated.iter().find(|(known, _)| *known == generated);
            return found.map(|(_, text)| (*text).into()).ok_or_else(missing);
        }
        if let Some(folder) = &self.library.folder {
            let file = folder.join(format!("{name}.wesl"));
            return std::fs::read_to_string(&file)
                .map(Cow::Owned)
                .map_err(|error| ResolveError::FileNotFound(file, error.to_string()));
        }
        let text = self.library.embedded.get(name.as_str());
        text.map(|text| (*text).into()).ok_or_else(missing)
    }

    fn display_name(&self, path: &ModulePath) -> Option<String> {
        Some(format!("shaders/{}.wesl", path.components.join("/")))
    }
}

/// `march::march` of module `march/march` becomes `march__march_march`: readable in captures, and
/// [`base_name`] gives back what the source says.
struct ReadableMangler;

impl Mangler for ReadableMangler {
    fn mangle(&self, path: &ModulePath, item: &str) -> String {
        format!("{item}__{}", path.components.join("_"))
    }
}

/// The name of a declaration as its own module spells it.
pub(super) fn base_name(mangled: &str) -> &str {
    mangled.split("__").next().unwrap_or(mangled)
}

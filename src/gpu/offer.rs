//! Resources and constants that one group of passes offers to another, by name.

/// Resources and constants that kernels may take by name.
#[derive(Clone, Default)]
pub struct Offer<'a> {
    /// Resources to bind. Of several with one name the first is bound.
    pub resources: Vec<(&'a str, wgpu::BindingResource<'a>)>,
    /// Values of `override` declarations; a kernel takes those that its shader declares.
    pub constants: Vec<(&'a str, f64)>,
}

impl<'a> Offer<'a> {
    /// A copy in which these resources replace others of the same names.
    pub fn with(
        &self,
        resources: impl IntoIterator<Item = (&'a str, wgpu::BindingResource<'a>)>,
    ) -> Self {
        Self {
            resources: resources
                .into_iter()
                .chain(self.resources.clone())
                .collect(),
            constants: self.constants.clone(),
        }
    }
}

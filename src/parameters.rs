//! Every tunable, declared once.

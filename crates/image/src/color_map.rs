//! colours for maps of errors.

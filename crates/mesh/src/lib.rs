//! Triangle meshes from OBJ, PLY and Mitsuba's serialized format.
#![forbid(unsafe_code)]

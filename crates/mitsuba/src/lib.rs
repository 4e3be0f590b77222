//! Mitsuba XML, versions 0.4 to 3, to the scene document.
#![forbid(unsafe_code)]

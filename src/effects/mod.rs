//! One physical effect per file, and the list.

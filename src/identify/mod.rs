//! One identification method per file, and the list.

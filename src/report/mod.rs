//! Study to blocks to HTML and PNG.

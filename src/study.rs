//! All results of one experiment: plain data, serialisable.

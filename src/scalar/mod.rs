pub(crate) mod fx;

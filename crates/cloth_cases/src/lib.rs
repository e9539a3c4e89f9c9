//! How much the tests of this workspace try: of what is searched at random a few cases, so that `cargo test` takes minutes, and all
//! of them where the variable `CLOTH_TESTS` is `all`, as in the checks of the repository.

/// `few` by default, `all` where all cases are asked for.
pub fn cases<T>(few: T, all: T) -> T {
    if std::env::var_os("CLOTH_TESTS").is_some_and(|value| value == "all") { all } else { few }
}

//! The paper, figure by figure: what each one claims, computed and checked.

//! What is kept, and what damages it.

mod damage;
mod finished;

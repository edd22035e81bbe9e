"""The one-time sweep over crack cells that fills the database in models/ (Paper A, section 2.2.3)."""

"""The window: what a person sees and touches while an avatar plays."""

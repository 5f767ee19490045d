"""The avatars, networks and demo clip that ship; origins and licences in NOTICE.md."""

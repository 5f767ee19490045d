"""How avatars are made from the command line: captured, trained, distilled, refined, fitted, taught."""

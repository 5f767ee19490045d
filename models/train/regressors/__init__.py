"""How an avatar learns to follow people: its responses, invented people, the closed loop, the graph that ships."""

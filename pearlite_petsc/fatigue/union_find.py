"""Disjoint sets of numbers that only ever unite."""


class UnionFind:
    """Disjoint sets; a number never seen is a set of its own."""

    def __init__(self) -> None:
        self._parent: dict[int, int] = {}

    def find(self, item: int) -> int:
        """Return the number that stands for the item's set."""
        parent = self._parent
        root = item
        while parent.setdefault(root, root) != root:
            root = parent[root]
        while parent[item] != root:
            parent[item], item = root, parent[item]
        return root

    def join(self, a: int, b: int) -> bool:
        """Unite the sets of a and b; return False where they were one already."""
        a, b = self.find(a), self.find(b)
        self._parent[a] = b
        return a != b

"""Groups of nodes by body, and sums over bodies."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, Shaped


class Groups(eqx.Module):
    """The body of each node."""

    member: Int[Array, "node"]
    count: int = eqx.field(static=True)
    ascending: bool = eqx.field(static=True, default=True)
    """True if nodes stand in the order of their bodies, which makes sums faster."""

    def total(self, values: Shaped[Array, "node *rest"]) -> Shaped[Array, "group *rest"]:
        """Return the sum over the nodes of each group."""
        if self.count == 1:
            return jnp.sum(values, 0, keepdims=True)
        return jax.ops.segment_sum(
            values, self.member, self.count, indices_are_sorted=self.ascending
        )

    def mean(
        self, values: Float[Array, "node *rest"], weights: Float[Array, "node"]
    ) -> Float[Array, "group *rest"]:
        """Return the weighted mean over the nodes of each group; 0 without weight."""
        total = self.total(weights)
        # A body of which nothing has grown has no weight: it must not divide by 0.
        total = jnp.where(total == 0, 1.0, total)
        shape = (-1, *(1,) * (values.ndim - 1))
        return self.total(weights.reshape(shape) * values) / total.reshape(shape)

    def largest(self, values: Shaped[Array, "node"]) -> Shaped[Array, "group"]:
        """Return the largest value in each group."""
        if self.count == 1:
            return jnp.max(values, keepdims=True)
        return jax.ops.segment_max(
            values, self.member, self.count, indices_are_sorted=self.ascending
        )

    def per_node(self, values: Shaped[Array, "group *rest"]) -> Shaped[Array, "node *rest"]:
        """Return, for every node, the value of its group."""
        if self.count == 1:
            return jnp.broadcast_to(values, (len(self.member), *values.shape[1:]))
        return values[self.member]

    def repeated(self, times: int) -> "Groups":
        """Return the groups of `times` adjacent points per node."""
        return Groups(jnp.repeat(self.member, times), self.count)


def single(nodes: int) -> Groups:
    """Return one group of all nodes."""
    return Groups(jnp.zeros(nodes, jnp.int32), 1)

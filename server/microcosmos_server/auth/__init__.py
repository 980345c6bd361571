"""Authentication and authorisation: tokens, scopes, middleware, rate limit."""

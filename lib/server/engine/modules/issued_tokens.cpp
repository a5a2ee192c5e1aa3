#include <busbar/server/modules.hpp>
#include <busbar/types/session.hpp>

#include "server/engine/core.hpp"
#include "server/engine/type_table.hpp"
#include "server/users/token_checks.hpp"

namespace busbar::server {

namespace detail {

namespace {

void add_issued_tokens(Core& core)
{
    core.session_needs.log_in_issued = log_in_issued;
    core.types.add(0, type_table<IssuedIdentityToken>());
}

} // namespace

} // namespace detail

constinit const Module modules::issued_tokens{"issued_tokens", detail::add_issued_tokens};

} // namespace busbar::server

#include <busbar/administration/administration.hpp>

#include <optional>

#include "node_table.hpp"
#include "role_set.hpp"

namespace busbar::administration {

struct Administration::Impl {
    explicit Impl(const AdministrationParts& p) : parts{p}, table{*p.wall_clock} {}

    AdministrationParts parts;
    detail::NodeTable table;
    std::optional<detail::RoleSet> role_set;
};

Administration::Administration(const AdministrationParts& parts)
    : impl_{std::make_unique<Impl>(parts)}
{
}

Administration::~Administration() = default;

Configured<void> Administration::attach(server::Server& server)
{
    server.add_source(impl_->table);
    if (impl_->parts.roles != nullptr) {
        impl_->role_set.emplace(server, *impl_->parts.roles, impl_->table, *impl_->parts.log);
        if (auto attached = impl_->role_set->attach(); !attached) {
            return attached;
        }
    }
    return {};
}

} // namespace busbar::administration

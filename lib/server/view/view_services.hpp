#pragma once

#include <busbar/types/view.hpp>

#include "server/session/service.hpp"
#include "view_context.hpp"

/// The View service set (Part 4, 5.9). All need an activated session.
namespace busbar::server::detail {

/// These are operations, as they may take several turns.
[[nodiscard]] std::unique_ptr<ServiceOperation> make_browse(const ViewNeeds& needs);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_browse_next(const ViewNeeds& needs);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_translate_browse_paths(const ViewNeeds& needs);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_register_nodes(const ViewNeeds& needs);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_unregister_nodes(const ViewNeeds& needs);

} // namespace busbar::server::detail

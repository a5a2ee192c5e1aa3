#pragma once

#include <busbar/core/waker.hpp>

namespace busbar::server {

using busbar::Waker;

} // namespace busbar::server

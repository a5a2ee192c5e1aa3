#include <busbar/channel/channel_types.hpp>

namespace busbar::channel {

std::string_view name(MessageSecurityMode mode)
{
    switch (mode) {
    case MessageSecurityMode::Invalid:
        return "Invalid";
    case MessageSecurityMode::None:
        return "None";
    case MessageSecurityMode::Sign:
        return "Sign";
    case MessageSecurityMode::SignAndEncrypt:
        return "SignAndEncrypt";
    }
    return {};
}

} // namespace busbar::channel

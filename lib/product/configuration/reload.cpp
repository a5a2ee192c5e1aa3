#include "reload.hpp"

namespace busbar::product {

std::string reload(const std::string& path, Settings& settings, Admission& admission, DateTime now)
{
    std::string text = "read again: ";
    if (!path.empty()) {
        settings.read_again(
            [&](const ControllerConfig& config) { admission.check_users(config.users, path); });
        const UserConfig& users = settings.config().users;
        admission.replace_users(users);
        text += std::to_string(users.accounts.size()) + " accounts of " + path + ", ";
    }
    return text + admission.read_certificates(now) +
           "; open sessions continue, and settings that cannot change at once take effect after a "
           "restart";
}

} // namespace busbar::product

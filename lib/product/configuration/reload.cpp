#include "reload.hpp"

#include <utility>

namespace busbar::product {

std::string reload(const std::string& path, Settings& settings, Admission& admission, DateTime now)
{
    std::string text = "read again: ";
    if (!path.empty()) {
        Admission::Users users;
        settings.read_again(
            [&](const ControllerConfig& config) { users = admission.prepare(config.users, path); });
        admission.admit(std::move(users)); // which cannot fail: the file counts as a whole
        text +=
            std::to_string(settings.config().users.accounts.size()) + " accounts of " + path + ", ";
    }
    return text + admission.read_certificates(now) +
           "; open sessions continue, and settings that cannot change at once take effect after a "
           "restart";
}

} // namespace busbar::product

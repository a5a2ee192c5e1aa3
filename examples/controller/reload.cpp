#include "reload.hpp"

namespace busbar::example {

std::string reload(const std::string& path, Admission& admission, DateTime now)
{
    std::string text = "read again: ";
    if (!path.empty()) {
        const ControllerConfig config = read_config(path);
        admission.replace_users(config.users, path);
        text += std::to_string(config.users.accounts.size()) + " accounts of " + path + ", ";
    }
    return text + admission.read_certificates(now) +
           "; sessions that are open go on, the rest of the configuration counts after a restart";
}

} // namespace busbar::example

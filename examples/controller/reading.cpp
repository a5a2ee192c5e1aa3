#include "reading.hpp"

#include "startup.hpp"

namespace busbar::example {

Reading read(const Origin& origin)
{
    Reading reading;
    reading.settings = std::make_unique<Settings>(origin.file, origin.preset);
    reading.config = reading.settings->config();
    ControllerConfig& config = reading.config;
    config.port = origin.port.value_or(config.port);
    if (!origin.project.empty()) {
        reading.project = std::make_unique<KeptProject>(origin.project);
        reading.project->apply(config, origin.port.has_value());
    }
    if (origin.file.empty()) {
        add_first_account(config);
    } else if (is_nobody(config.users) && !config.users.has_setup) {
        throw ConfigError{origin.file, "nobody can log in, expected an account, anonymous, "
                                       "certificates or tokens in [users]: see --print-config"};
    }
    return reading;
}

} // namespace busbar::example

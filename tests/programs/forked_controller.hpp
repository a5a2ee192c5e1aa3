#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <sys/types.h>

#include <busbar/harness/chance.hpp>
#include <busbar/product/configuration.hpp>

#include "support/failing_disk.hpp"

namespace busbar::test {

/// A product::Controller in a process of its own, which is killed as power cuts do, and whose disk
/// fails when a test wants it to. One thread.
class ForkedController {
public:
    /// `log` is where it says what it does. Starts nothing yet.
    ForkedController(product::Configuration configuration, std::string log);
    ForkedController(const ForkedController&) = delete;
    ForkedController& operator=(const ForkedController&) = delete;
    ~ForkedController();

    /// What became of a start.
    enum class Start : std::uint8_t {
        Serves,
        /// why_not() tells.
        Refused,
        /// It was killed meanwhile, as orders() say.
        Killed,
    };
    /// Of one that does not run. Connections of this process must be closed.
    [[nodiscard]] Start start();
    /// With SIGKILL. Does nothing if it does not run.
    void kill();
    /// Has it end in order.
    void terminate();
    /// Has it read everything again; what it says of that is in the log later.
    void hang_up() const;

    /// False also if it has been killed by its orders or has ended itself.
    [[nodiscard]] bool is_running();
    [[nodiscard]] const std::string& why_not() const { return why_not_; }
    [[nodiscard]] failing_disk::Orders& orders() { return *orders_; }
    /// Nothing fails any more, and nothing kills it.
    void calm();
    /// What its media are going to do.
    struct Fault {
        /// They fail, or else it is to be killed.
        bool is_of_media;
        std::string text;
    };
    /// Gives orders() for one of the next calls, or none.
    [[nodiscard]] std::optional<Fault> draw_fault(harness::Chance& chance);

private:
    product::Configuration configuration_;
    std::string log_;
    failing_disk::Orders* orders_; // in memory that is shared
    ::pid_t process_{-1};
    std::string why_not_;
};

} // namespace busbar::test

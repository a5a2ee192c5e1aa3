#pragma once

#include <memory>

namespace busbar::fuzz {

/// A world for many inputs: most of the time of each would go into making one. There is a new one
/// now and then, so that what an input leaves behind does not stay for ever.
template <typename World>
class KeptWorld {
public:
    [[nodiscard]] World& next()
    {
        if (!world_ || ++inputs_ % 4'096 == 0) {
            world_ = std::make_unique<World>();
        }
        return *world_;
    }
    /// The next input needs another one.
    void drop() { world_.reset(); }

private:
    std::unique_ptr<World> world_;
    int inputs_{0};
};

} // namespace busbar::fuzz

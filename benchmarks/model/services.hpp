#pragma once

#include <cstdint>
#include <memory>

#include <busbar/model/address_space.hpp>

namespace busbar::bench {

/// A server over an address space and a client, in one thread and over a None channel in memory.
/// What is measured is the time that the server takes, with encoding and decoding.
class Services {
public:
    explicit Services(model::AddressSpace space);
    Services(const Services&) = delete;
    Services& operator=(const Services&) = delete;
    ~Services();

    [[nodiscard]] const model::AddressSpace& space() const;

    struct Cost {
        double microseconds{0};
        /// References, or targets.
        std::size_t results{0};
    };
    /// All references of a node forward by `type` and its subtypes, in one response.
    [[nodiscard]] Cost browse(const NodeId& node, const NodeId& type);
    /// The same, `page` references at a time.
    [[nodiscard]] Cost browse_pages(const NodeId& node, const NodeId& type, std::uint32_t page);
    /// One request for the paths from Objects to `count` variables of add_machine, spread over
    /// all `variables`.
    [[nodiscard]] Cost translate(std::uint32_t count, std::uint32_t variables);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::bench

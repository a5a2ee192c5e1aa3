#pragma once

namespace busbar::test {

/// While one of these lives, RSA is not done again for what it was done for before: the program
/// takes the text of a cipher text, or the signature of a text, from the time before. Key, padding
/// and bytes must be the same, and only what succeeded is remembered, so nothing but the time that
/// it takes differs: channels that all open with the same bytes take a fraction of it. For one
/// thread. Without effect below shared libraries.
class RememberedRsa {
public:
    RememberedRsa() { ++lives; }
    RememberedRsa(const RememberedRsa&) = delete;
    RememberedRsa& operator=(const RememberedRsa&) = delete;
    ~RememberedRsa() { --lives; }

    static inline int lives{0};
};

} // namespace busbar::test

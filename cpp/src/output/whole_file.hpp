#pragma once

#include <filesystem>
#include <string>

namespace der {

/// Files that other programs see as they were, or whole and new, never a part of them: they are
/// written under a temporary name, and then take the place of the old one.

/// The temporary name of a file, in the same folder.
std::filesystem::path temporary_name(const std::filesystem::path& file);

/// Writes a text. A temporary file that is there is replaced; where it is a link, that is removed
/// and what it points to is left alone. Throws IoError.
void write_atomically(const std::filesystem::path& file, const std::string& text);

/// Gives a file that is whole its name. Throws IoError.
void publish(const std::filesystem::path& temporary, const std::filesystem::path& file);

/// Removes a file or a link, if it is there. Throws IoError.
void remove_file(const std::filesystem::path& file);

}  // namespace der

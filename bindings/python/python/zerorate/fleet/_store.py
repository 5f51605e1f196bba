"""Files and rows in a folder or an object store, by fsspec."""

from __future__ import annotations

import glob
import hashlib
import os
import stat as stats
import uuid
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import fsspec

ROWS = "rows"


class Unreachable(Exception):
    """A store cannot be read or written. The text names the store and the reason."""


@lru_cache(maxsize=8)
def _filesystem(protocol: str) -> Any:
    # A cached listing would hide the rows that other workers write.
    return fsspec.filesystem(protocol, use_listings_cache=False, skip_instance_cache=True)


def opened(url: str) -> tuple[Any, str]:
    """The file system of an address, and the path there. Keys and endpoints come from the environment."""
    protocol, separator, _ = url.partition("://")
    try:
        filesystem = _filesystem(protocol if separator else "file")
    except (ImportError, ValueError) as error:
        raise Unreachable(f"{url}: {error}") from error
    return filesystem, str(filesystem._strip_protocol(url)).rstrip("/") or "/"


def is_local(filesystem: Any) -> bool:
    protocol = filesystem.protocol
    return "file" in ((protocol,) if isinstance(protocol, str) else protocol)


@dataclass(frozen=True)
class File:
    """A file of the fleet with one version of its content."""

    url: str
    version: str
    """ETag of an object; size and modification time of a file."""
    size: int

    def key(self, digest: str) -> str:
        """The name under which the result of this file is stored. `digest` identifies the settings of the analysis."""
        name = f"{self.url}|{self.version}|{digest}"
        return hashlib.sha256(name.encode("utf-8", "surrogatepass")).hexdigest()[:24]


@dataclass
class Found:
    """What a source holds."""

    files: list[File] = field(default_factory=list)
    """The files, sorted by address."""
    others: dict[str, str] = field(default_factory=dict)
    """What else has a name there, by address, in words: a pipe, a device, a link to a folder."""


OTHERS = {stats.S_IFIFO: "a pipe", stats.S_IFSOCK: "a socket", stats.S_IFCHR: "a device", stats.S_IFBLK: "a device"}


def find(source: str) -> Found:
    """The file with this address, or all files of a folder, a glob or a bucket."""
    filesystem, path = opened(source)
    is_folder = False
    try:
        # an existing path is not a pattern, even if its name has letters such as * or [
        if filesystem.isfile(path):
            found = {path: filesystem.info(path)}
        elif is_folder := filesystem.isdir(path):
            found = filesystem.find(path, detail=True)
        else:
            found = filesystem.glob(path, detail=True)
    except Exception as error:
        raise Unreachable(f"{source} cannot be listed: {error}") from error
    if not found and not is_pattern(source) and not is_folder:
        raise Unreachable(f"{source}: there is no such file or folder")
    infos = [_followed(filesystem, info) for info in found.values()]
    files = (_file(filesystem, info) for info in infos if info["type"] == "file")
    others = ((info["name"], _other(info)) for info in infos if info["type"] != "file")
    return Found(sorted(files, key=lambda file: file.url), {name: what for name, what in others if what})


def is_pattern(source: str) -> bool:
    return bool(glob.has_magic(source))


def _other(info: dict[str, Any]) -> str:
    """What is no file, in words; nothing for a folder that a pattern fits."""
    if info["type"] == "directory":
        return "a link to a folder" if info.get("islink") else ""
    return OTHERS.get(stats.S_IFMT(info.get("mode", 0)), "not a file")


def _followed(filesystem: Any, info: dict[str, Any]) -> dict[str, Any]:
    """Follows a link to its target. A link without one counts as a file, so that it is reported and not left out."""
    if not info.get("islink"):
        return info
    try:
        return dict(filesystem.info(info["name"]))
    except OSError:  # the target does not exist, or is the link itself
        return {**info, "type": "file"}


def inside(url: str) -> str:
    """The prefix that the addresses of all files in a folder have."""
    filesystem, path = opened(url)
    return f"{path if is_local(filesystem) else filesystem.unstrip_protocol(path)}/"


def remove_path(out: str, path: str) -> None:
    opened(out)[0].rm_file(path)


def stat(url: str) -> File:
    """The file with its present size and version."""
    filesystem, path = opened(url)
    return _file(filesystem, filesystem.info(path))


def _file(filesystem: Any, info: dict[str, Any]) -> File:
    etag = next((info[name] for name in ("ETag", "etag", "md5Hash", "content_md5") if info.get(name)), None)
    version = str(etag).strip('"') if etag else f"{info['size']}-{_modified(info)}"
    url = info["name"] if is_local(filesystem) else filesystem.unstrip_protocol(info["name"])
    return File(url, version, int(info["size"]))


def _modified(info: dict[str, Any]) -> str:
    names = ("mtime", "LastModified", "updated", "last_modified", "created")
    return str(next((info[name] for name in names if info.get(name)), ""))


def fetch(file: File, folder: str) -> str:
    """Copies the file into `folder` and returns the path of the copy. A local file is not copied."""
    filesystem, path = opened(file.url)
    if is_local(filesystem):
        return path
    local = os.path.join(folder, os.path.basename(path))
    filesystem.get_file(path, local)
    return local


def put(url: str, data: bytes) -> None:
    """Writes a file completely or not at all."""
    filesystem, path = opened(url)
    if not is_local(filesystem):
        filesystem.pipe_file(path, data)
        return
    os.makedirs(os.path.dirname(path), exist_ok=True)
    part = f"{path}.{uuid.uuid4().hex}.part"
    try:
        with open(part, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException:
        if os.path.exists(part):
            os.remove(part)
        raise


def row_url(out: str, key: str) -> str:
    """The address of the row with this key. Rows are spread over 256 folders, so that a million rows can be listed in
    parts."""
    return f"{out.rstrip('/')}/{ROWS}/{key[:2]}/{key}.json"


def exists(url: str) -> bool:
    filesystem, path = opened(url)
    return bool(filesystem.exists(path))


def read(url: str) -> bytes:
    filesystem, path = opened(url)
    return _bytes(filesystem, path)


def row_paths(out: str) -> list[str]:
    """The paths of all rows in their file system. Files with another extension are unfinished rows."""
    return _found(out, ROWS, ".json")


def part_paths(out: str, folder: str) -> list[str]:
    return _found(out, folder, ".parquet")


def _found(out: str, folder: str, ending: str) -> list[str]:
    filesystem, path = opened(out)
    try:
        found = filesystem.find(f"{path}/{folder}")
    except FileNotFoundError:
        return []
    except Exception as error:
        raise Unreachable(f"{out} cannot be listed: {error}") from error
    return sorted(name for name in found if name.endswith(ending))


def contents(out: str, paths: list[str], together: int = 1000) -> Iterator[dict[str, bytes]]:
    """Yields the contents of files, `together` of them at a time."""
    filesystem, _ = opened(out)
    for first in range(0, len(paths), together):
        some = paths[first : first + together]
        yield {path: _bytes(filesystem, path) for path in some} if is_local(filesystem) else filesystem.cat(some)


def _bytes(filesystem: Any, path: str) -> bytes:
    data: bytes = filesystem.cat_file(path)
    return data

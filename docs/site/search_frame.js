// Browsers start no worker on a page opened as a file, and the theme's search runs in one. Here its
// script runs in a hidden frame, which has a global scope of its own too. The frame is empty since
// an empty page counts as part of the page that made it, whereas another file counts as a stranger.
class FrameWorker extends EventTarget {
  #frame = document.createElement("iframe");
  #ready;

  constructor(script) {
    super();
    this.#frame.hidden = true;
    // Not before "load": some browsers make the empty page twice, and the first is lost.
    const loaded = new Promise((resolve) => this.#frame.addEventListener("load", resolve));
    this.#ready = loaded.then(() => this.#start(new URL(script, document.baseURI)));
    document.body.append(this.#frame);
  }

  async postMessage(data) {
    // As with a worker, neither side may notice what the other later does with the data.
    const message = { data: structuredClone(data) };
    const scope = await this.#ready;
    scope.dispatchEvent(new scope.MessageEvent("message", message));
  }

  async #start(address) {
    const scope = this.#frame.contentWindow;
    // A frame's own postMessage would bring the worker's answers to the worker.
    scope.postMessage = (data) => this.#answer(structuredClone(data));
    // Only a worker can stand still until a script is there; the theme's awaits this promise.
    // Addresses are relative to the worker's script, but would be taken as to the page.
    scope.importScripts = async (...scripts) => {
      for (const name of scripts) await FrameWorker.#load(scope.document, new URL(name, address));
    };
    await FrameWorker.#load(scope.document, address);
    return scope;
  }

  #answer(data) {
    const event = new MessageEvent("message", { data });
    // Later, as from a worker: whoever asked may have more to do before it can take an answer.
    setTimeout(() => {
      this.onmessage?.(event);
      this.dispatchEvent(event);
    });
  }

  static #load(page, address) {
    return new Promise((resolve, reject) => {
      const script = page.createElement("script");
      script.onload = resolve;
      script.onerror = () => reject(new Error(`${address} was not loaded`));
      script.src = address;
      page.body.append(script);
    });
  }
}

if (location.protocol === "file:") window.Worker = FrameWorker;

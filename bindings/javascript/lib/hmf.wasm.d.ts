/** For bundlers that turn `import address from 'hmf/hmf.wasm'` into an address. */
declare const address: string;
export default address;
